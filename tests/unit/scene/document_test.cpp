/// The document: what is read, what is refused and in which words, what is written back.

#include "scene/document.hpp"

#include "tests/unit/scene/beam_scene.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace sprung {
namespace {

using test::scene_error;

constexpr const char* sample = R"(title = "A \"quoted\" title\twith \u00b5"

[numbers]
count = 121
factor = 0.1
whole = 3
tiny = 1e-300
on = true
length = "3.75 mm"
lengths = ["1 mm", "2 cm"]
mode = "paper"
modes = ["fast", "slow"]

[solid.beam]
box = { from = ["0 m", "1 m"], to = ["2 m", "3 m"] }

[solid.arm]
"odd key" = 1
)";

Document document(const std::vector<std::string>& overrides = {}) {
  return Document::from_text(sample, "scene.toml", overrides);
}

TEST(Document, ReadsEveryKindOfValue) {
  const auto scene = document();
  EXPECT_EQ(scene.root().text("title"), "A \"quoted\" title\twith \u00b5");
  const auto table = scene.table("numbers");
  EXPECT_EQ(table.name(), "numbers");
  EXPECT_EQ(table.integer("count"), 121);
  EXPECT_EQ(table.number("factor"), 0.1);
  EXPECT_EQ(table.number("whole"), 3.0);
  EXPECT_EQ(table.number("tiny"), 1e-300);
  EXPECT_TRUE(table.flag("on"));
  EXPECT_EQ(table.quantity("length", dimension::length), 0.00375);
  EXPECT_EQ(table.quantities("lengths", dimension::length), (std::vector<double>{0.001, 0.02}));
  EXPECT_EQ(table.word("mode", {"paper", "recommended"}), "paper");
  EXPECT_EQ(table.words("modes", {"fast", "slow"}), (std::vector<std::string>{"fast", "slow"}));
  EXPECT_EQ(table.keys(), (std::vector<std::string>{"count", "factor", "whole", "tiny", "on",
                                                    "length", "lengths", "mode", "modes"}));
  const auto solids = scene.table("solid");
  EXPECT_EQ(solids.table_names(), (std::vector<std::string>{"beam", "arm"}));  // the file's order
  EXPECT_EQ(solids.table("arm").integer("odd key"), 1);
  const auto box = scene.table("solid.beam").table("box");
  EXPECT_EQ(box.name(), "solid.beam.box");
  EXPECT_EQ(box.quantities("to", dimension::length), (std::vector<double>{2, 3}));
  EXPECT_TRUE(scene.has("solid.arm"));
  EXPECT_FALSE(scene.has("solid.leg"));
  EXPECT_FALSE(scene.has("title"));  // a value, not a table
  EXPECT_NO_THROW(scene.root().table("solid").table("beam"));
  box.quantities("from", dimension::length);
  EXPECT_NO_THROW(scene.refuse_unread());
}

TEST(Document, SameFromFileAndFromText) {
  const auto file = std::filesystem::path(testing::TempDir()) / "document_test.toml";
  std::ofstream(file) << sample;
  const Document scene(file, {"numbers.count=5"});
  EXPECT_EQ(scene.file(), file);
  EXPECT_EQ(scene.table("numbers").integer("count"), 5);
  EXPECT_EQ(scene_error([&] { scene.table("numbers").integer("factor"); }),
            file.string() +
                ":5: [numbers] factor = 0.1: a bare number where a whole number is needed; "
                "write it without quotes, point or unit, such as 121");
  std::filesystem::remove(file);
}

TEST(Document, ReadsListsOfTextsAndListsOfLists) {
  const auto scene = Document::from_text(R"toml([t]
texts = ["sin(x)", "", "1"]
rows = [["1 mm", "2 cm"], [], ["3 m"]]
none = []
deep = [[["1 m"]]]
mixed = [["1 m", "2 s"]]
)toml",
                                         "s.toml");
  const auto table = scene.table("t");
  EXPECT_EQ(table.texts("texts"), (std::vector<std::string>{"sin(x)", "", "1"}));
  EXPECT_EQ(table.quantity_rows("rows", dimension::length),
            (std::vector<std::vector<double>>{{0.001, 0.02}, {}, {3}}));
  EXPECT_TRUE(table.texts("none").empty());
  EXPECT_TRUE(table.quantity_rows("none", dimension::length).empty());
  EXPECT_EQ(scene_error([&] { table.quantity_rows("mixed", dimension::length); }),
            "s.toml:6: [t] mixed = [[\"1 m\", \"2 s\"]]: \"2 s\": a time where a length is needed; "
            "write a length, such as \"3.75 mm\"");
  EXPECT_EQ(scene_error([&] { table.quantity_rows("deep", dimension::length); }),
            "s.toml:5: [t] deep = [[[\"1 m\"]]]: a list where a quantity with its unit is "
            "needed; write a length, such as \"3.75 mm\"");
  EXPECT_EQ(scene_error([&] { table.texts("rows"); }),
            "s.toml:3: [t] rows = [[\"1 mm\", \"2 cm\"], [], [\"3 m\"]]: a list "
            "where a text is needed; write a list of texts in brackets, each in quotes");
  EXPECT_EQ(scene_error([&] { table.texts("nowhere"); }),
            "s.toml:1: [t] nowhere is missing; write a list of texts in brackets, each in quotes");
}

TEST(Document, RefusesFilesThatAreNone) {
  EXPECT_EQ(scene_error([] { Document("/nowhere/beam.toml"); }),
            "/nowhere/beam.toml: no such scene file; check the path");
  EXPECT_EQ(scene_error([] { Document("/tmp"); }), "/tmp: not a file; name the scene's .toml file");
}

// --- wrong values -------------------------------------------------------------------------------

struct Refusal {
  const char* key;
  void (*read)(const Table&, const std::string&);
  const char* message;
};

class RefusedRead : public testing::TestWithParam<Refusal> {};

TEST_P(RefusedRead, HasLineValueAndRemedy) {
  const auto& [key, read, message] = GetParam();
  const auto scene = Document::from_text(R"([t]
text = "word"
bare = 3.75
whole = 3
nan = nan
inf = -inf
flag = true
day = 2024-05-06
list = ["1 m", 2]
wrong = ["1 m", "2 s"]
inline = { a = 1 }
length = "0.7 mm"
words = ["fast", "slwo"]
)",
                                         "s.toml");
  const auto table = scene.table("t");
  EXPECT_EQ(scene_error([&] { read(table, key); }), message);
}

const auto text = [](const Table& t, const std::string& k) { t.text(k); };
const auto word = [](const Table& t, const std::string& k) { t.word(k, {"paper", "fast"}); };
const auto words = [](const Table& t, const std::string& k) { t.words(k, {"slow", "fast"}); };
const auto flag = [](const Table& t, const std::string& k) { t.flag(k); };
const auto integer = [](const Table& t, const std::string& k) { t.integer(k); };
const auto number = [](const Table& t, const std::string& k) { t.number(k); };
const auto length = [](const Table& t, const std::string& k) { t.quantity(k, dimension::length); };
const auto pressure = [](const Table& t, const std::string& k) {
  t.quantity(k, dimension::pressure);
};
const auto lengths = [](const Table& t, const std::string& k) {
  t.quantities(k, dimension::length);
};
const auto table = [](const Table& t, const std::string& k) { t.table(k); };

INSTANTIATE_TEST_SUITE_P(
    Kinds, RefusedRead,
    testing::Values(
        Refusal{
            "bare", length,
            "s.toml:3: [t] bare = 3.75: a bare number where a quantity with its unit is needed; "
            "write a length, such as \"3.75 mm\""},
        Refusal{"length", pressure,
                "s.toml:12: [t] length = \"0.7 mm\": a length where a pressure is needed; write a "
                "pressure, such as \"0.7 MPa\""},
        Refusal{"nan", number,
                "s.toml:5: [t] nan = nan: not a finite number; write one, such as 0.5"},
        Refusal{"inf", number,
                "s.toml:6: [t] inf = -inf: not a finite number; write one, such as 0.5"},
        Refusal{"nan", length,
                "s.toml:5: [t] nan = nan: a bare number where a quantity with its unit is needed; "
                "write "
                "a length, such as \"3.75 mm\""},
        Refusal{"text", number,
                "s.toml:2: [t] text = \"word\": a text where a plain number is needed; write it "
                "without "
                "quotes and unit, such as 0.5"},
        Refusal{"text", integer,
                "s.toml:2: [t] text = \"word\": a text where a whole number is needed; write it "
                "without "
                "quotes, point or unit, such as 121"},
        Refusal{
            "text", flag,
            "s.toml:2: [t] text = \"word\": a text where true or false is needed; write true or "
            "false without quotes"},
        Refusal{
            "flag", text,
            "s.toml:7: [t] flag = true: true or false where a text is needed; write it in quotes, "
            "\"...\""},
        Refusal{"day", text,
                "s.toml:8: [t] day = 2024-05-06: a date or time of day where a text is needed; "
                "write it "
                "in quotes, \"...\""},
        Refusal{
            "whole", word,
            "s.toml:4: [t] whole = 3: a bare number where a word is needed; write one of \"paper\" "
            "or \"fast\""},
        Refusal{
            "text", word,
            "s.toml:2: [t] text = \"word\": \"word\" is not a choice here; write one of \"paper\" "
            "or \"fast\""},
        Refusal{"words", words,
                "s.toml:13: [t] words = [\"fast\", \"slwo\"]: \"slwo\" is not a choice here; the "
                "nearest "
                "is \"slow\"; write one of \"slow\" or \"fast\""},
        Refusal{"text", words,
                "s.toml:2: [t] text = \"word\": a text where a list is needed; write a list of "
                "\"slow\" "
                "or \"fast\", such as [\"slow\"]"},
        Refusal{
            "list", lengths,
            "s.toml:9: [t] list = [\"1 m\", 2]: a bare number where a quantity with its unit is "
            "needed; write a length, such as \"3.75 mm\""},
        Refusal{
            "wrong", lengths,
            "s.toml:10: [t] wrong = [\"1 m\", \"2 s\"]: \"2 s\": a time where a length is needed; "
            "write a length, such as \"3.75 mm\""},
        Refusal{
            "length", lengths,
            "s.toml:12: [t] length = \"0.7 mm\": a text where a list is needed; write a list in "
            "brackets, each element a length, such as \"3.75 mm\""},
        Refusal{
            "inline", length,
            "s.toml:11: [t] inline = { a = 1 }: a table where a quantity with its unit is needed; "
            "write a length, such as \"3.75 mm\""},
        Refusal{"text", table,
                "s.toml:2: [t] text = \"word\": a text where a table is needed; write text = { ... "
                "} or "
                "a section in brackets"},
        Refusal{"absent", length,
                "s.toml:1: [t] absent is missing; write a length, such as \"3.75 mm\""},
        Refusal{"absent", word,
                "s.toml:1: [t] absent is missing; write one of \"paper\" or \"fast\""},
        Refusal{"absent", table, "s.toml:1: [t] absent is missing; write a table [t.absent]"},
        // A misspelt key is named where it stands, not reported as missing.
        Refusal{
            "lenght", length,
            "s.toml:12: [t] length = \"0.7 mm\": unknown key; the nearest known word is lenght"}));

TEST(Document, RefuseNamesValueOrTable) {
  const auto scene = document();
  const auto table = scene.table("numbers");
  EXPECT_EQ(scene_error([&] { table.refuse("count", "too many; write 3"); }),
            "scene.toml:4: [numbers] count = 121: too many; write 3");
  EXPECT_EQ(scene_error([&] { table.refuse("absent", "needed; write it"); }),
            "scene.toml:3: [numbers] absent: needed; write it");
  EXPECT_EQ(scene_error([&] { table.refuse("", "superfluous; remove it"); }),
            "scene.toml:3: [numbers]: superfluous; remove it");
  EXPECT_EQ(scene_error([&] { scene.root().refuse("", "empty"); }), "scene.toml: empty");
  EXPECT_EQ(scene_error([&] { scene.root().refuse("title", "dull"); }),
            "scene.toml:1: title = \"A \\\"quoted\\\" title\\twith \u00b5\": dull");
  EXPECT_EQ(scene_error([&] { scene.root().refuse("numbers", "odd"); }),
            "scene.toml:3: [numbers]: odd");
}

// --- TOML that is none --------------------------------------------------------------------------

TEST(Syntax, ErrorsHaveFileLineAndTheLineItself) {
  const auto error = scene_error([] { Document::from_text("[time]\n\nend = 3 s\n", "s.toml"); });
  EXPECT_TRUE(error.starts_with("s.toml:3: end = 3 s: not valid TOML: ")) << error;
  EXPECT_TRUE(error.ends_with("write one key = value per line, text and quantities in quotes"))
      << error;
}

TEST(Syntax, RepeatedKeysAndTablesAreErrors) {
  EXPECT_TRUE(scene_error([] {
                Document::from_text("a = 1\na = 2\n", "s.toml");
              }).starts_with("s.toml:2: a = 2: not valid TOML: "));
  EXPECT_TRUE(scene_error([] {
                Document::from_text("[a]\n[a]\n", "s.toml");
              }).starts_with("s.toml:2: [a]: not valid TOML: "));
  EXPECT_TRUE(scene_error([] {
                Document::from_text("a = \"never ends\n", "s.toml");
              }).starts_with("s.toml:1: a = \"never ends: not valid TOML: "));
  EXPECT_FALSE(scene_error([] { Document::from_text("a = \"\xff\xfe\"\n", "s.toml"); }).empty());
}

// --- unread keys --------------------------------------------------------------------------------

TEST(Unread, NamesTheNearestWordAskedFor) {
  const auto scene = Document::from_text("[sph]\nspacing = \"1 mm\"\nshfting = true\n", "s.toml");
  const auto table = scene.table("sph");
  table.quantity("spacing", dimension::length);
  table.flag_or("shifting", false);
  EXPECT_EQ(scene_error([&] { scene.refuse_unread(); }),
            "s.toml:3: [sph] shfting = true: unknown key; the nearest known word is shifting");
}

TEST(Unread, ListsTheWordsWhenNoneIsNear) {
  const auto scene = Document::from_text("[sph]\nspacing = \"1 mm\"\ncolour = 1\n", "s.toml");
  const auto table = scene.table("sph");
  table.quantity("spacing", dimension::length);
  table.has("shifting");
  EXPECT_EQ(scene_error([&] { scene.refuse_unread(); }),
            "s.toml:3: [sph] colour = 1: unknown key; [sph] takes shifting and spacing");
}

TEST(Unread, TablesToo) {
  const auto scene = Document::from_text("[wals]\nno_slip = []\n[sph]\n", "s.toml");
  scene.has("walls");
  scene.table("sph");
  EXPECT_EQ(scene_error([&] { scene.refuse_unread(); }),
            "s.toml:1: [wals]: unknown table; the nearest known word is walls");
}

TEST(Unread, KnownWordsWithoutEffectAreNamedAsSuch) {
  const auto scene = Document::from_text("[sph]\nramp = \"1 s\"\n", "s.toml");
  scene.table("sph").has("ramp");
  EXPECT_EQ(scene_error([&] { scene.refuse_unread(); }),
            "s.toml:2: [sph] ramp = \"1 s\": this key has no effect in this scene; remove it");
}

TEST(Unread, FirstLineFirstAndInsideInlineTables) {
  const auto scene = Document::from_text("[a]\nbox = { from = 1, form = 2 }\nz = 1\n", "s.toml");
  scene.table("a").table("box").integer("from");
  EXPECT_EQ(scene_error([&] { scene.refuse_unread(); }),
            "s.toml:2: [a.box] form = 2: unknown key; the nearest known word is from");
}

TEST(Unread, AnotherProgramsTableIsLeftAlone) {
  auto scene = Document::from_text("[reference_fem]\ncell_size = 1\n[reference_fem.deep]\nx = 1\n");
  EXPECT_FALSE(scene_error([&] { scene.refuse_unread(); }).empty());
  scene.leave_unread("reference_fem");
  scene.leave_unread("never_there");
  EXPECT_NO_THROW(scene.refuse_unread());
}

// --- overrides ----------------------------------------------------------------------------------

TEST(Override, ReplacesAndAdds) {
  const auto scene = document({"numbers.length=2.5 mm", "numbers.on=false", "numbers.count = 7",
                               "numbers.mode=recommended", "numbers.lengths=[\"5 m\"]",
                               "numerics.preset=paper", "deep.er.key=\"in quotes\"", "extra=0.5"});
  const auto table = scene.table("numbers");
  EXPECT_EQ(table.quantity("length", dimension::length), 0.0025);
  EXPECT_FALSE(table.flag("on"));
  EXPECT_EQ(table.integer("count"), 7);
  EXPECT_EQ(table.word("mode", {"paper", "recommended"}), "recommended");
  EXPECT_EQ(table.quantities("lengths", dimension::length), (std::vector<double>{5}));
  EXPECT_EQ(scene.table("numerics").word("preset", {"paper"}), "paper");
  EXPECT_EQ(scene.table("deep.er").text("key"), "in quotes");
  EXPECT_EQ(scene.root().number("extra"), 0.5);
}

TEST(Override, TheLaterOneHolds) {
  const auto scene = document({"numbers.count=7", "numbers.count=8"});
  EXPECT_EQ(scene.table("numbers").integer("count"), 8);
}

TEST(Override, ReplacesAWholeTableByATable) {
  const auto scene = document({"solid.beam.box={ from = [\"9 m\"] }"});
  const auto box = scene.table("solid.beam.box");
  EXPECT_EQ(box.keys(), (std::vector<std::string>{"from"}));
  EXPECT_EQ(box.quantities("from", dimension::length), (std::vector<double>{9}));
  const auto inner = document({"solid.beam.box.to=[\"7 m\", \"8 m\"]"});
  EXPECT_EQ(inner.table("solid.beam.box").quantities("to", dimension::length),
            (std::vector<double>{7, 8}));
}

TEST(Override, GoesThroughTheSameChecks) {
  const auto refusal = [](const std::string& override_text) {
    return scene_error([&] {
      const auto scene = document({override_text});
      const auto table = scene.table("numbers");
      table.quantity("length", dimension::length);
      table.integer("count");
      if (scene.has("solid.bean")) scene.table("solid.bean").table("box");
      scene.refuse_unread();
    });
  };
  EXPECT_EQ(refusal("numbers.length=2.5 s"),
            "command line: [numbers] length = \"2.5 s\": a time where a length is needed; write a "
            "length, such as \"3.75 mm\"");
  EXPECT_EQ(refusal("numbers.length=3"),
            "command line: [numbers] length = 3: a bare number where a quantity with its unit is "
            "needed; write a length, such as \"3.75 mm\"");
  EXPECT_EQ(refusal("numbers.length=inf"),
            "command line: [numbers] length = inf: a bare number where a quantity with its unit is "
            "needed; write a length, such as \"3.75 mm\"");
  EXPECT_EQ(refusal("solid.bean.box.from=[\"1 m\"]"), refusal("solid.bean.box.from=[\"1 m\"]"));
  EXPECT_EQ(
      refusal("solid.bean.stiffness=3"),
      "command line: [solid.bean]: the scene has no such table; the nearest is [solid.beam]; a "
      "new one would need box");
}

TEST(Override, UnknownKeysAreTheCommandLines) {
  const auto scene =
      Document::from_text("[sph]\nspacing = \"1 mm\"\n", "s.toml", {"sph.spcing=2 mm"});
  scene.table("sph").quantity("spacing", dimension::length);
  EXPECT_EQ(
      scene_error([&] { scene.refuse_unread(); }),
      "command line: [sph] spcing = \"2 mm\": unknown key; the nearest known word is spacing");
  const auto other = Document::from_text("[sph]\n", "s.toml", {"numercs.preset=paper"});
  other.table("sph");
  other.has("numerics");
  EXPECT_EQ(scene_error([&] { other.refuse_unread(); }),
            "command line: [numercs]: unknown table; the nearest known word is numerics");
}

TEST(Override, MalformedOnesAreRefused) {
  const auto refusal = [](const std::string& text) {
    return scene_error([&] { document({text}); });
  };
  const std::string write = "write table.key=value, such as sph.spacing=\"2.5 mm\"";
  EXPECT_EQ(refusal("spacing"), "command line: spacing: not an override; " + write);
  EXPECT_EQ(refusal("a..b=1"), "command line: a..b=1: the part before = is not a path; " + write);
  EXPECT_EQ(refusal("=1"), "command line: =1: the part before = is not a path; " + write);
  EXPECT_EQ(refusal("a b.c=1"), "command line: a b.c=1: the part before = is not a path; " + write);
  EXPECT_EQ(refusal("a.b="), "command line: a.b=: no value after =; write table.key=value");
  EXPECT_EQ(refusal("numbers=3"),
            "command line: numbers=3: [numbers] is a table; set one of its keys, such as "
            "numbers.count=...");
  EXPECT_EQ(refusal("title.sub=3"),
            "command line: title.sub=3: title is a value, not a table; write title=...");
  const auto bracket = refusal("numbers.lengths=[\"1 m\"");
  EXPECT_TRUE(
      bracket.starts_with("command line: numbers.lengths=[\"1 m\": the value is not valid TOML"))
      << bracket;
}

// --- the resolved scene -------------------------------------------------------------------------

TEST(Resolved, ReadsBackAsTheSameText) {
  const auto scene =
      document({"numerics.preset=paper", "title=later", "solid.beam.extra={ a = [1, 2.0] }"});
  const auto once = scene.resolved_toml();
  const auto twice = Document::from_text(once).resolved_toml();
  EXPECT_EQ(once, twice);
}

TEST(Resolved, HoldsOverridesAndDefaults) {
  const auto scene =
      Document::from_text("[sph]\nspacing = \"1 mm\"\n", "s.toml", {"sph.spacing=2 mm"});
  const auto sph = scene.table("sph");
  EXPECT_EQ(sph.number_or("smoothing", 1.3), 1.3);
  EXPECT_EQ(sph.integer_or("layers", 3), 3);
  EXPECT_TRUE(sph.flag_or("shifting", true));
  EXPECT_EQ(sph.quantity_or("step", dimension::time, "1 ms"), 0.001);
  EXPECT_EQ(sph.number_or("whole", 2.0), 2.0);
  const auto numerics = scene.table_or_new("numerics");
  EXPECT_EQ(numerics.word_or("preset", {"paper", "recommended"}, "recommended"), "recommended");
  EXPECT_EQ(scene.resolved_toml(), R"([sph]
spacing = "2 mm"
smoothing = 1.3
layers = 3
shifting = true
step = "1 ms"
whole = 2.0

[numerics]
preset = "recommended"
)");
  EXPECT_NO_THROW({
    sph.quantity("spacing", dimension::length);
    scene.refuse_unread();
  });
}

TEST(Resolved, KeepsEmptyTablesAndOddKeys) {
  const auto scene = Document::from_text("[empty]\n[a.\"b.c\"]\n\"x y\" = 0.1\nz = 1e300\n");
  EXPECT_EQ(scene.resolved_toml(), "[empty]\n\n[a.\"b.c\"]\n\"x y\" = 0.1\nz = 1e+300\n");
  EXPECT_EQ(Document::from_text(scene.resolved_toml()).resolved_toml(), scene.resolved_toml());
}

// Every double is written so that it reads back as the same bits.
TEST(Resolved, NumbersKeepEveryBit) {
  for (const double value :
       {0.1, 1.0 / 3.0, 6.02214076e23, 5e-324, -1.7976931348623157e308, 1e16}) {
    const auto scene = Document::from_text("[t]\n");
    scene.table("t").number_or("x", value);
    EXPECT_EQ(Document::from_text(scene.resolved_toml()).table("t").number("x"), value);
  }
}

}  // namespace
}  // namespace sprung
