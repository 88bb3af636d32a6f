#include "scene/spelling.hpp"

#include <gtest/gtest.h>

namespace sprung {
namespace {

TEST(EditDistance, CountsByHand) {
  EXPECT_EQ(edit_distance("spacing", "spacing"), 0);
  EXPECT_EQ(edit_distance("spcing", "spacing"), 1);    // one letter missing
  EXPECT_EQ(edit_distance("spaccing", "spacing"), 1);  // one too many
  EXPECT_EQ(edit_distance("spasing", "spacing"), 1);   // one wrong
  EXPECT_EQ(edit_distance("psacing", "spacing"), 1);   // two swapped
  EXPECT_EQ(edit_distance("Spacing", "spacing"), 0);   // capitals do not count
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);  // Levenshtein's textbook pair
}

TEST(NearestWord, IsNearOrNone) {
  EXPECT_EQ(nearest_word("shfting", {"spacing", "shifting"}), "shifting");
  EXPECT_EQ(nearest_word("colour", {"spacing", "shifting"}), "");
  EXPECT_EQ(nearest_word("to", {"t0"}), "t0");
  EXPECT_EQ(nearest_word("word", {}), "");
}

TEST(ListWords, JoinsThem) {
  EXPECT_EQ(list_words({"a"}, true), "\"a\"");
  EXPECT_EQ(list_words({"a", "b"}, false), "a or b");
  EXPECT_EQ(list_words({"a", "b", "c"}, true, "and"), "\"a\", \"b\" and \"c\"");
}

}  // namespace
}  // namespace sprung
