#include "scene/document.hpp"

#include "scene/document_tree.hpp"
#include "scene/spelling.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace sprung {

using namespace document_tree;

struct Table::Content {
  std::shared_ptr<Node> node;
};

namespace {

constexpr std::size_t longest_shown_value = 160;

std::string place(const Node& node, const Origin& origin) {
  if (origin.command_line) return "command line: ";
  if (origin.line == 0) return node.file + ": ";
  return node.file + ":" + std::to_string(origin.line) + ": ";
}

std::string in_table(const Node& node) {
  return node.name.empty() ? "" : "[" + node.name + "] ";
}

std::string shown(const Value& value) {
  const auto text = to_toml(value);
  return text.size() <= longest_shown_value ? text : text.substr(0, longest_shown_value) + "...";
}

[[noreturn]] void refuse_entry(const Node& node, const Entry& entry, const std::string& reason) {
  const bool section = entry.value.is_table() && !entry.value.table()->is_inline;
  if (section)
    throw SceneError(place(node, entry.origin) + "[" + entry.value.table()->name + "]: " + reason);
  throw SceneError(place(node, entry.origin) + in_table(node) + entry.key + " = " +
                   shown(entry.value) + ": " + reason);
}

std::vector<std::string> known_words(const Node& node, const std::string& except) {
  std::vector<std::string> words;
  for (const auto& word : node.known)
    if (word != except) words.push_back(word);
  return words;
}

/// Why nobody read `entry`, and what was probably meant.
[[noreturn]] void refuse_unknown(const Node& node, const Entry& entry) {
  const std::string kind = entry.value.is_table() ? "table" : "key";
  if (node.known.contains(entry.key))
    refuse_entry(node, entry, "this " + kind + " has no effect in this scene; remove it");
  const auto known = known_words(node, "");
  const auto nearest = nearest_word(entry.key, known);
  const std::string where = node.name.empty() ? "a scene" : "[" + node.name + "]";
  if (!nearest.empty())
    refuse_entry(node, entry, "unknown " + kind + "; the nearest known word is " + nearest);
  if (known.empty()) refuse_entry(node, entry, "unknown " + kind + "; " + where + " takes none");
  refuse_entry(node, entry,
               "unknown " + kind + "; " + where + " takes " + list_words(known, false, "and"));
}

/// The table stands on the command line but not in the file, and one of similar name does.
void refuse_invented_table(const Node& node, const std::string& missing) {
  if (!node.origin.command_line || !node.parent) return;
  std::vector<std::string> siblings;
  for (const auto& entry : node.parent->entries)
    if (entry.value.is_table() && entry.value.table().get() != &node) siblings.push_back(entry.key);
  const std::string prefix = node.parent->name.empty() ? "" : node.parent->name + ".";
  const std::string key = node.name.substr(prefix.size());
  const auto nearest = nearest_word(key, siblings);
  throw SceneError("command line: [" + node.name + "]: the scene has no such table" +
                   (nearest.empty() ? "" : "; the nearest is [" + prefix + nearest + "]") +
                   "; a new one would need " + missing);
}

/// `key` is absent. A key of similar name that nobody asks for is the likely culprit.
[[noreturn]] void refuse_missing(const Node& node, const std::string& key,
                                 const std::string& need) {
  std::vector<std::string> candidates;
  for (const auto& entry : node.entries)
    if (!entry.read && !node.known.contains(entry.key)) candidates.push_back(entry.key);
  const auto misspelt = nearest_word(key, candidates);
  if (!misspelt.empty()) {
    const Entry& entry = *const_cast<Node&>(node).find(misspelt);
    const std::string kind = entry.value.is_table() ? "table" : "key";
    refuse_entry(node, entry, "unknown " + kind + "; the nearest known word is " + key);
  }
  refuse_invented_table(node, key);
  throw SceneError(place(node, node.origin) + in_table(node) + key + " is missing; " + need);
}

Entry& required(const std::shared_ptr<Node>& node, const std::string& key,
                const std::string& need) {
  node->known.insert(key);
  Entry* entry = node->find(key);
  if (!entry) refuse_missing(*node, key, need);
  entry->read = true;
  return *entry;
}

std::string kind_of(const Value& value) {
  struct {
    std::string operator()(const std::string&) const { return "a text"; }
    std::string operator()(std::int64_t) const { return "a bare number"; }
    std::string operator()(double) const { return "a bare number"; }
    std::string operator()(bool) const { return "true or false"; }
    std::string operator()(const Date&) const { return "a date or time of day"; }
    std::string operator()(const List&) const { return "a list"; }
    std::string operator()(const std::shared_ptr<Node>&) const { return "a table"; }
  } kind;
  return std::visit(kind, value.data);
}

[[noreturn]] void refuse_kind(const Node& node, const Entry& entry, const Value& value,
                              const std::string& needed, const std::string& remedy) {
  refuse_entry(node, entry, kind_of(value) + " where " + needed + " is needed; " + remedy);
}

std::string one_of(const std::vector<std::string>& choices) {
  return (choices.size() > 1 ? "one of " : "") + list_words(choices, true);
}

std::string word_in(const Node& node, const Entry& entry, const Value& value,
                    const std::vector<std::string>& choices) {
  const auto* word = std::get_if<std::string>(&value.data);
  if (!word) refuse_kind(node, entry, value, "a word", "write " + one_of(choices));
  if (std::find(choices.begin(), choices.end(), *word) != choices.end()) return *word;
  const auto nearest = nearest_word(*word, choices);
  refuse_entry(node, entry,
               "\"" + *word + "\" is not a choice here; " +
                   (nearest.empty() ? "write " : "the nearest is \"" + nearest + "\"; write ") +
                   one_of(choices));
}

double quantity_in(const Node& node, const Entry& entry, const Value& value,
                   const Dimension& dimension) {
  const auto* text = std::get_if<std::string>(&value.data);
  if (!text)
    refuse_kind(node, entry, value, "a quantity with its unit", "write " + describe(dimension));
  try {
    return parse_quantity(*text, dimension);
  } catch (const QuantityError& error) {
    refuse_entry(node, entry, &value == &entry.value ? error.reason() : std::string(error.what()));
  }
}

const List& list_in(const Node& node, const Entry& entry, const std::string& remedy) {
  const auto* list = std::get_if<List>(&entry.value.data);
  if (!list) refuse_kind(node, entry, entry.value, "a list", remedy);
  return *list;
}

bool is_present(const std::shared_ptr<Node>& node, const std::string& key) {
  node->known.insert(key);
  return node->find(key) != nullptr;
}

void record_default(const std::shared_ptr<Node>& node, const std::string& key, Value value) {
  node->entries.push_back({key, std::move(value), node->origin, true});
}

std::vector<std::string> split(const std::string& dotted) {
  std::vector<std::string> keys;
  std::istringstream parts(dotted);
  for (std::string part; std::getline(parts, part, '.');) keys.push_back(part);
  return keys;
}

void mark_all_read(Node& node) {
  node.opened = true;
  for (auto& entry : node.entries) {
    entry.read = true;
    if (entry.value.is_table()) mark_all_read(*entry.value.table());
  }
}

/// The unread entries of the tree with their tables, in the file's order, the command line's last.
void collect_unread(const Node& node, std::vector<std::pair<const Node*, const Entry*>>& unread) {
  for (const auto& entry : node.entries) {
    const bool table = entry.value.is_table();
    if (table ? !entry.value.table()->opened : !entry.read)
      unread.emplace_back(&node, &entry);
    else if (table)
      collect_unread(*entry.value.table(), unread);
  }
}

std::string read_text(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    throw SceneError(file.string() + ": no such scene file; check the path");
  if (!std::filesystem::is_regular_file(file, error))
    throw SceneError(file.string() + ": not a file; name the scene's .toml file");
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw SceneError(file.string() + ": cannot be read; check its permissions");
  return text.str();
}

}  // namespace

Table::Table(std::shared_ptr<Content> content, std::string name)
    : content_(std::move(content)), name_(std::move(name)) {}

bool Table::has(const std::string& key) const {
  return is_present(content_->node, key);
}

std::vector<std::string> Table::keys() const {
  std::vector<std::string> keys;
  for (const auto& entry : content_->node->entries) keys.push_back(entry.key);
  return keys;
}

std::string Table::text(const std::string& key) const {
  const Entry& entry =
      required(content_->node, key, "write a text in quotes, " + key + " = \"...\"");
  const auto* text = std::get_if<std::string>(&entry.value.data);
  if (!text)
    refuse_kind(*content_->node, entry, entry.value, "a text", "write it in quotes, \"...\"");
  return *text;
}

std::string Table::word(const std::string& key, const std::vector<std::string>& choices) const {
  const Entry& entry = required(content_->node, key, "write " + one_of(choices));
  return word_in(*content_->node, entry, entry.value, choices);
}

std::vector<std::string> Table::words(const std::string& key,
                                      const std::vector<std::string>& choices) const {
  const std::string remedy = "write a list of " + list_words(choices, true) + ", such as [\"" +
                             (choices.empty() ? "" : choices.front()) + "\"]";
  const Entry& entry = required(content_->node, key, remedy);
  std::vector<std::string> words;
  for (const auto& element : list_in(*content_->node, entry, remedy))
    words.push_back(word_in(*content_->node, entry, element, choices));
  return words;
}

std::vector<std::string> Table::texts(const std::string& key) const {
  const std::string remedy = "write a list of texts in brackets, each in quotes";
  const Entry& entry = required(content_->node, key, remedy);
  std::vector<std::string> texts;
  for (const auto& element : list_in(*content_->node, entry, remedy)) {
    const auto* text = std::get_if<std::string>(&element.data);
    if (!text) refuse_kind(*content_->node, entry, element, "a text", remedy);
    texts.push_back(*text);
  }
  return texts;
}

bool Table::flag(const std::string& key) const {
  const Entry& entry = required(content_->node, key, "write true or false");
  const auto* flag = std::get_if<bool>(&entry.value.data);
  if (!flag)
    refuse_kind(*content_->node, entry, entry.value, "true or false",
                "write true or false without quotes");
  return *flag;
}

long Table::integer(const std::string& key) const {
  const Entry& entry = required(content_->node, key, "write a whole number");
  if (const auto* number = std::get_if<std::int64_t>(&entry.value.data)) return *number;
  refuse_kind(*content_->node, entry, entry.value, "a whole number",
              "write it without quotes, point or unit, such as 121");
}

double Table::number(const std::string& key) const {
  const Entry& entry = required(content_->node, key, "write a plain number, such as 0.5");
  if (const auto* whole = std::get_if<std::int64_t>(&entry.value.data))
    return static_cast<double>(*whole);
  const auto* number = std::get_if<double>(&entry.value.data);
  if (!number)
    refuse_kind(*content_->node, entry, entry.value, "a plain number",
                "write it without quotes and unit, such as 0.5");
  if (!std::isfinite(*number))
    refuse_entry(*content_->node, entry, "not a finite number; write one, such as 0.5");
  return *number;
}

double Table::quantity(const std::string& key, const Dimension& dimension) const {
  const Entry& entry = required(content_->node, key, "write " + describe(dimension));
  return quantity_in(*content_->node, entry, entry.value, dimension);
}

std::vector<double> Table::quantities(const std::string& key, const Dimension& dimension) const {
  const std::string remedy = "write a list in brackets, each element " + describe(dimension);
  const Entry& entry = required(content_->node, key, remedy);
  std::vector<double> values;
  for (const auto& element : list_in(*content_->node, entry, remedy))
    values.push_back(quantity_in(*content_->node, entry, element, dimension));
  return values;
}

std::vector<std::vector<double>> Table::quantity_rows(const std::string& key,
                                                      const Dimension& dimension) const {
  const std::string remedy =
      "write a list of lists in brackets, each element of the inner ones " + describe(dimension);
  const Entry& entry = required(content_->node, key, remedy);
  std::vector<std::vector<double>> rows;
  for (const auto& row : list_in(*content_->node, entry, remedy)) {
    const auto* list = std::get_if<List>(&row.data);
    if (!list) refuse_kind(*content_->node, entry, row, "a list", remedy);
    rows.emplace_back();
    for (const auto& element : *list)
      rows.back().push_back(quantity_in(*content_->node, entry, element, dimension));
  }
  return rows;
}

std::string Table::word_or(const std::string& key, const std::vector<std::string>& choices,
                           const std::string& fallback) const {
  if (!has(key)) record_default(content_->node, key, {fallback});
  return word(key, choices);
}

bool Table::flag_or(const std::string& key, bool fallback) const {
  if (!has(key)) record_default(content_->node, key, {fallback});
  return flag(key);
}

long Table::integer_or(const std::string& key, long fallback) const {
  if (!has(key)) record_default(content_->node, key, {std::int64_t{fallback}});
  return integer(key);
}

double Table::number_or(const std::string& key, double fallback) const {
  if (!has(key)) record_default(content_->node, key, {fallback});
  return number(key);
}

double Table::quantity_or(const std::string& key, const Dimension& dimension,
                          const std::string& fallback) const {
  if (!has(key)) record_default(content_->node, key, {fallback});
  return quantity(key, dimension);
}

Table Table::table(const std::string& key) const {
  const auto& node = content_->node;
  node->known.insert(key);
  Entry* entry = node->find(key);
  if (!entry) {
    const std::string dotted = name_.empty() ? key : name_ + "." + key;
    refuse_missing(*node, key, "write a table [" + dotted + "]");
  }
  entry->read = true;
  if (!entry->value.is_table())
    refuse_kind(*node, *entry, entry->value, "a table",
                "write " + key + " = { ... } or a section in brackets");
  auto child = entry->value.table();
  child->opened = true;
  const std::string child_name = child->name;
  return Table(std::make_shared<Content>(Content{std::move(child)}), child_name);
}

std::vector<std::string> Table::table_names() const {
  std::vector<std::string> names;
  for (const auto& entry : content_->node->entries)
    if (entry.value.is_table()) names.push_back(entry.key);
  return names;
}

void Table::refuse(const std::string& key, const std::string& reason) const {
  const Node& node = *content_->node;
  if (!key.empty()) {
    if (const Entry* entry = content_->node->find(key)) refuse_entry(node, *entry, reason);
    throw SceneError(place(node, node.origin) + in_table(node) + key + ": " + reason);
  }
  throw SceneError(place(node, node.origin) + (node.name.empty() ? "" : "[" + node.name + "]: ") +
                   reason);
}

Document::Document(const std::filesystem::path& file, const std::vector<std::string>& overrides)
    : file_(file),
      content_(
          std::make_shared<Table::Content>(Table::Content{parse(read_text(file), file.string())})) {
  for (const auto& override_text : overrides) apply_override(*content_->node, override_text);
  content_->node->opened = true;
}

Document Document::from_text(const std::string& text, const std::string& name,
                             const std::vector<std::string>& overrides) {
  Document document;
  document.file_ = name;
  document.content_ = std::make_shared<Table::Content>(Table::Content{parse(text, name)});
  for (const auto& override_text : overrides)
    apply_override(*document.content_->node, override_text);
  document.content_->node->opened = true;
  return document;
}

Table Document::root() const {
  return Table(content_, "");
}

bool Document::has(const std::string& table) const {
  std::shared_ptr<Node> node = content_->node;
  for (const auto& key : split(table)) {
    node->known.insert(key);
    node = node->child(key);
    if (!node) return false;
  }
  return true;
}

Table Document::table(const std::string& dotted_name) const {
  Table table = root();
  for (const auto& key : split(dotted_name)) table = table.table(key);
  return table;
}

Table Document::table_or_new(const std::string& dotted_name) const {
  Table table = root();
  for (const auto& key : split(dotted_name)) {
    if (!table.has(key)) table.content_->node->add_child(key, {});
    table = table.table(key);
  }
  return table;
}

void Document::leave_unread(const std::string& table) {
  std::shared_ptr<Node> node = content_->node;
  for (const auto& key : split(table)) {
    node->opened = true;
    node->known.insert(key);
    if (Entry* entry = node->find(key)) entry->read = true;
    node = node->child(key);
    if (!node) return;
  }
  mark_all_read(*node);
}

void Document::refuse_unread() const {
  std::vector<std::pair<const Node*, const Entry*>> unread;
  collect_unread(*content_->node, unread);
  if (unread.empty()) return;
  const auto first =
      std::min_element(unread.begin(), unread.end(), [](const auto& a, const auto& b) {
        const auto rank = [](const Entry& entry) {
          return std::pair(entry.origin.command_line, entry.origin.line);
        };
        return rank(*a.second) < rank(*b.second);
      });
  refuse_unknown(*first->first, *first->second);
}

std::string Document::resolved_toml() const {
  return to_toml(*content_->node);
}

}  // namespace sprung
