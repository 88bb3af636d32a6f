#pragma once
/// The scene file as a checked document: every value is read with its unit, dimension and line;
/// whatever nobody reads is an error.

#include "scene/quantity.hpp"

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace sprung {

/// A scene that cannot be run as written. what() is the whole message for the user:
/// "beam.toml:12: [solid.beam] youngs_modulus = \"0.7 mm\": ...; write a pressure, such as \"0.7
/// MPa\"".
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One table of the document, for instance [solid.beam]. A light handle; the Document must outlive
/// it. Every read marks its key as known; has() makes it a known word but leaves it unread. All
/// reads throw SceneError with file, line, value and remedy.
class Table {
 public:
  /// Full dotted name ("solid.beam"); empty for the root.
  const std::string& name() const { return name_; }
  bool has(const std::string& key) const;
  /// Keys in the file's order.
  std::vector<std::string> keys() const;

  std::string text(const std::string& key) const;
  /// A list of texts.
  std::vector<std::string> texts(const std::string& key) const;
  /// One of `choices`; anything else is refused with the nearest choice named.
  std::string word(const std::string& key, const std::vector<std::string>& choices) const;
  std::vector<std::string> words(const std::string& key,
                                 const std::vector<std::string>& choices) const;
  bool flag(const std::string& key) const;
  long integer(const std::string& key) const;
  /// A plain, dimensionless, finite number.
  double number(const std::string& key) const;
  /// SI value of a quantity written with its unit.
  double quantity(const std::string& key, const Dimension& dimension) const;
  std::vector<double> quantities(const std::string& key, const Dimension& dimension) const;
  /// A list of such lists: points, for instance.
  std::vector<std::vector<double>> quantity_rows(const std::string& key,
                                                 const Dimension& dimension) const;

  /// The same with a default for numerics; the default is written into the resolved document.
  std::string word_or(const std::string& key, const std::vector<std::string>& choices,
                      const std::string& fallback) const;
  bool flag_or(const std::string& key, bool fallback) const;
  long integer_or(const std::string& key, long fallback) const;
  double number_or(const std::string& key, double fallback) const;
  double quantity_or(const std::string& key, const Dimension& dimension,
                     const std::string& fallback) const;

  Table table(const std::string& key) const;
  /// Names of the tables inside this one ("beam" in [solid]).
  std::vector<std::string> table_names() const;

  /// Refuses the value at `key` (or the table itself if the key is absent or empty), with its line
  /// and value in the message; `reason` says what is wrong and what to do.
  [[noreturn]] void refuse(const std::string& key, const std::string& reason) const;

 private:
  friend class Document;
  struct Content;
  Table(std::shared_ptr<Content> content, std::string name);
  std::shared_ptr<Content> content_;
  std::string name_;
};

class Document {
 public:
  /// Reads `file` and applies `overrides` ("sph.spacing=2.5 mm", "solid.beam.youngs_modulus=0.35
  /// MPa", "sph.shifting=none", "sph.gradient_correction=true"): each goes through the checks of
  /// the file, and an error in one names it as "command line". A value that is not a TOML literal
  /// is taken as a string; of two for the same key the later one holds. Throws SceneError.
  explicit Document(const std::filesystem::path& file,
                    const std::vector<std::string>& overrides = {});
  /// The same from text, for tests; `name` stands where a file name would.
  static Document from_text(const std::string& text, const std::string& name = "scene",
                            const std::vector<std::string>& overrides = {});

  const std::filesystem::path& file() const { return file_; }
  Table root() const;
  bool has(const std::string& table) const;
  Table table(const std::string& dotted_name) const;
  /// The same, added empty if the scene has none: for tables whose keys all have defaults
  /// ([numerics]), so that the defaults are written out.
  Table table_or_new(const std::string& dotted_name) const;

  /// Marks a table as another program's business ("reference_fem" for the particle solver).
  void leave_unread(const std::string& table);
  /// Throws SceneError for the first key that no one has read, naming the nearest known word.
  void refuse_unread() const;

  /// The scene as it is run: overrides applied, defaults written out (those read so far: call it
  /// when everything has been read). Valid TOML without comments; reading it again
  /// gives the same scene.
  std::string resolved_toml() const;

 private:
  Document() = default;
  std::filesystem::path file_;
  std::shared_ptr<Table::Content> content_;
};

}  // namespace sprung
