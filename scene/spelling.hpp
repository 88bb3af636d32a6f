#pragma once
/// The nearest known word, for error messages about misspelt keys and choices.

#include <string>
#include <vector>

namespace sprung {

/// Number of insertions, deletions, replacements and swaps of neighbours that turn `a` into `b`
/// (optimal string alignment distance; upper and lower case count as equal).
int edit_distance(const std::string& a, const std::string& b);

/// The word of `known` nearest to `word`, the first of equals; empty if none is near enough to be a
/// likely misspelling (more than a third of the letters wrong, but at least one always may be).
std::string nearest_word(const std::string& word, const std::vector<std::string>& known);

/// "a, b or c", each in double quotes if `quoted`.
std::string list_words(const std::vector<std::string>& words, bool quoted,
                       const std::string& last_joint = "or");

}  // namespace sprung
