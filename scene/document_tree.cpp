#include "scene/document_tree.hpp"

#include "scene/document.hpp"
#include "scene/spelling.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

namespace sprung::document_tree {

Entry* Node::find(const std::string& key) {
  for (auto& entry : entries)
    if (entry.key == key) return &entry;
  return nullptr;
}

std::shared_ptr<Node> Node::child(const std::string& key) {
  Entry* entry = find(key);
  return entry && entry->value.is_table() ? entry->value.table() : nullptr;
}

namespace {

std::string join(const std::string& table, const std::string& key) {
  return table.empty() ? key : table + "." + key;
}

std::shared_ptr<Node> convert(const toml::table& table, Node* parent, const std::string& key,
                              const Origin& origin, const std::string& file);

Value convert(const toml::node& node, Node* parent, const std::string& key, const Origin& origin) {
  switch (node.type()) {
    case toml::node_type::string:
      return {node.as_string()->get()};
    case toml::node_type::integer:
      return {node.as_integer()->get()};
    case toml::node_type::floating_point:
      return {node.as_floating_point()->get()};
    case toml::node_type::boolean:
      return {node.as_boolean()->get()};
    case toml::node_type::array: {
      List list;
      for (const auto& element : *node.as_array()) {
        list.push_back(convert(element, parent, key, origin));
      }
      return {std::move(list)};
    }
    case toml::node_type::table:
      return {convert(*node.as_table(), parent, key, origin, parent->file)};
    default: {
      std::ostringstream text;
      node.visit([&](const auto& value) {
        if constexpr (toml::is_chronological<decltype(value)>) text << value.get();
      });
      return {Date{text.str()}};
    }
  }
}

std::shared_ptr<Node> convert(const toml::table& table, Node* parent, const std::string& key,
                              const Origin& origin, const std::string& file) {
  auto node = std::make_shared<Node>();
  node->file = file;
  node->parent = parent;
  node->name = parent ? join(parent->name, key) : "";
  node->origin = origin;
  node->is_inline = table.is_inline();
  // toml++ sorts its keys; their places in the text give back the order of the file.
  std::vector<std::pair<toml::source_position, const toml::key*>> order;
  for (auto&& [name, value] : table) order.emplace_back(name.source().begin, &name);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [position, name] : order) {
    Origin place = origin;
    if (!origin.command_line) place.line = static_cast<long>(position.line);
    std::string text(name->str());
    Value value = convert(*table.get(name->str()), node.get(), text, place);
    node->entries.push_back({std::move(text), std::move(value), place, false});
  }
  return node;
}

std::string line_of(const std::string& text, std::size_t number) {
  std::istringstream lines(text);
  std::string line;
  for (std::size_t i = 0; i < number; ++i)
    if (!std::getline(lines, line)) return "";
  const auto first = line.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  line = line.substr(first, line.find_last_not_of(" \t\r") - first + 1);
  return line.size() > 100 ? line.substr(0, 100) + "..." : line;
}

bool is_bare_key(const std::string& key) {
  return !key.empty() && std::all_of(key.begin(), key.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '-';
  });
}

[[noreturn]] void refuse_override(const std::string& override_text, const std::string& reason) {
  throw SceneError("command line: " + override_text + ": " + reason);
}

std::string trim(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// The literal that the command line gave, or the text itself if it is none ("2.5 mm", none).
Value override_value(const std::string& text, const std::string& override_text, Node& parent,
                     const std::string& key) {
  const Origin origin{0, true};
  try {
    const toml::table parsed = toml::parse("value = " + text);
    if (parsed.size() == 1) return convert(*parsed.get("value"), &parent, key, origin);
  } catch (const toml::parse_error& error) {
    if (text.find_first_of("[{\"'") == 0)
      refuse_override(override_text, "the value is not valid TOML (" +
                                         std::string(error.description()) +
                                         "); check its quotes and brackets");
  }
  return {text};
}

std::vector<std::string> split_path(const std::string& path, const std::string& override_text) {
  std::vector<std::string> keys;
  std::istringstream parts(path + ".");
  for (std::string part; std::getline(parts, part, '.');) {
    keys.push_back(trim(part));
    if (!is_bare_key(keys.back()))
      refuse_override(override_text,
                      "the part before = is not a path; write table.key=value, such as "
                      "sph.spacing=\"2.5 mm\"");
  }
  return keys;
}

std::string example_key(const Node& node) {
  return join(node.name, node.entries.empty() ? "key" : node.entries.front().key);
}

}  // namespace

std::shared_ptr<Node> Node::add_child(const std::string& key, const Origin& where) {
  auto node = std::make_shared<Node>();
  node->name = join(name, key);
  node->file = file;
  node->origin = where;
  node->parent = this;
  entries.push_back({key, {node}, where, false});
  return node;
}

std::shared_ptr<Node> parse(const std::string& text, const std::string& file) {
  try {
    const toml::table table = toml::parse(text, file);
    return convert(table, nullptr, "", {}, file);
  } catch (const toml::parse_error& error) {
    const auto line = error.source().begin.line;
    const std::string seen = line_of(text, line);
    throw SceneError(file + ":" + std::to_string(line) + ": " + (seen.empty() ? "" : seen + ": ") +
                     "not valid TOML: " + std::string(error.description()) +
                     "; write one key = value per line, text and quantities in quotes");
  }
}

void apply_override(Node& root, const std::string& override_text) {
  const auto equals = override_text.find('=');
  if (equals == std::string::npos)
    refuse_override(override_text,
                    "not an override; write table.key=value, such as sph.spacing=\"2.5 mm\"");
  const auto keys = split_path(override_text.substr(0, equals), override_text);
  const auto text = trim(override_text.substr(equals + 1));
  if (text.empty()) refuse_override(override_text, "no value after =; write table.key=value");

  Node* table = &root;
  for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
    Entry* entry = table->find(keys[i]);
    if (entry && !entry->value.is_table())
      refuse_override(override_text, join(table->name, keys[i]) +
                                         " is a value, not a table; write " +
                                         join(table->name, keys[i]) + "=...");
    table = entry ? entry->value.table().get() : table->add_child(keys[i], Origin{0, true}).get();
  }
  Value value = override_value(text, override_text, *table, keys.back());
  Entry* entry = table->find(keys.back());
  if (!entry) {
    table->entries.push_back({keys.back(), std::move(value), Origin{0, true}, false});
    return;
  }
  if (entry->value.is_table() && !value.is_table())
    refuse_override(override_text, "[" + entry->value.table()->name +
                                       "] is a table; set one of its keys, such as " +
                                       example_key(*entry->value.table()) + "=...");
  if (entry->value.is_table()) value.table()->is_inline = entry->value.table()->is_inline;
  entry->value = std::move(value);
  entry->origin = Origin{0, true};
}

namespace {

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (c == '\n') {
      result += "\\n";
    } else if (c == '\t') {
      result += "\\t";
    } else if (byte < 0x20 || byte == 0x7f) {
      static constexpr char hex[] = "0123456789abcdef";
      result += "\\u00";
      result += hex[byte >> 4];
      result += hex[byte & 15];
    } else {
      result += c;
    }
  }
  return result + "\"";
}

std::string toml_number(double number) {
  if (std::isnan(number)) return "nan";
  if (std::isinf(number)) return number > 0 ? "inf" : "-inf";
  char buffer[40];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, number).ptr;
  std::string text(buffer, end);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string toml_key(const std::string& key) {
  return is_bare_key(key) ? key : quoted(key);
}

std::string inline_table(const Node& node) {
  std::string text = "{";
  for (const auto& entry : node.entries)
    text += (text.size() > 1 ? ", " : " ") + toml_key(entry.key) + " = " + to_toml(entry.value);
  return text + (node.entries.empty() ? "}" : " }");
}

void append_table(std::string& text, const Node& node, const std::string& path) {
  bool has_values = false;
  bool has_tables = false;
  for (const auto& entry : node.entries) {
    const bool section = entry.value.is_table() && !entry.value.table()->is_inline;
    has_values = has_values || !section;
    has_tables = has_tables || section;
  }
  if (!path.empty() && (has_values || !has_tables)) {
    if (!text.empty()) text += "\n";
    text += "[" + path + "]\n";
  }
  for (const auto& entry : node.entries)
    if (!entry.value.is_table() || entry.value.table()->is_inline)
      text += toml_key(entry.key) + " = " + to_toml(entry.value) + "\n";
  for (const auto& entry : node.entries)
    if (entry.value.is_table() && !entry.value.table()->is_inline)
      append_table(text, *entry.value.table(), join(path, toml_key(entry.key)));
}

struct ToToml {
  std::string operator()(const std::string& text) const { return quoted(text); }
  std::string operator()(std::int64_t number) const { return std::to_string(number); }
  std::string operator()(double number) const { return toml_number(number); }
  std::string operator()(bool flag) const { return flag ? "true" : "false"; }
  std::string operator()(const Date& date) const { return date.text; }
  std::string operator()(const List& list) const {
    std::string text = "[";
    for (const auto& element : list) text += (text.size() > 1 ? ", " : "") + to_toml(element);
    return text + "]";
  }
  std::string operator()(const std::shared_ptr<Node>& table) const { return inline_table(*table); }
};

}  // namespace

std::string toml_library_version() {
  return std::to_string(TOML_LIB_MAJOR) + "." + std::to_string(TOML_LIB_MINOR) + "." +
         std::to_string(TOML_LIB_PATCH);
}

std::string to_toml(const Value& value) {
  return std::visit(ToToml{}, value.data);
}

std::string to_toml(const Node& root) {
  std::string text;
  append_table(text, root, "");
  return text;
}

}  // namespace sprung::document_tree
