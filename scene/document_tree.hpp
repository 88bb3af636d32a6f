#pragma once
/// The scene file as a tree of keys and values that remember where they were written and whether
/// anyone has read them. Private to the library: programs use scene/document.hpp.

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <variant>
#include <vector>

namespace sprung::document_tree {

/// Where a value was written: a line of the file, or the command line.
struct Origin {
  long line = 0;  ///< 0: unknown
  bool command_line = false;
};

struct Node;
struct Value;
using List = std::vector<Value>;

/// A date or time: valid TOML that no key of a scene takes.
struct Date {
  std::string text;
};

struct Value {
  std::variant<std::string, std::int64_t, double, bool, Date, List, std::shared_ptr<Node>> data;

  bool is_table() const { return std::holds_alternative<std::shared_ptr<Node>>(data); }
  const std::shared_ptr<Node>& table() const { return std::get<std::shared_ptr<Node>>(data); }
};

struct Entry {
  std::string key;
  Value value;
  Origin origin;
  bool read = false;
};

struct Node {
  std::string name;  ///< dotted, empty for the root
  std::string file;  ///< as messages name it
  Origin origin;
  bool is_inline = false;  ///< written as { ... }
  bool opened = false;     ///< asked for as a table
  Node* parent = nullptr;
  std::vector<Entry> entries;   ///< in the file's order
  std::set<std::string> known;  ///< keys that someone has asked for

  Entry* find(const std::string& key);
  /// The sub-table `key`, or null.
  std::shared_ptr<Node> child(const std::string& key);
  /// Adds an empty sub-table.
  std::shared_ptr<Node> add_child(const std::string& key, const Origin& origin);
};

/// Parses TOML text. Throws SceneError with the file's name and the line.
std::shared_ptr<Node> parse(const std::string& text, const std::string& file);

/// Applies "table.key=value" to the tree. Throws SceneError that begins with "command line".
void apply_override(Node& root, const std::string& override_text);

/// Version of the TOML library.
std::string toml_library_version();

/// The value as TOML, on one line.
std::string to_toml(const Value& value);
/// The tree as a TOML document.
std::string to_toml(const Node& root);

}  // namespace sprung::document_tree
