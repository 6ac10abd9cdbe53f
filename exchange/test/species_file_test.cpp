#include "anthesis/exchange/species_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "anthesis/base/random.h"
#include "anthesis/base/sha256.h"

namespace anthesis {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

// Every kind of key at least once. Line numbers matter: tests name them.
constexpr const char* kDaisy = R"(name = "daisy"
latin = "Bellis perennis"
summary = "A lawn daisy."

[head]
divergence_deg = 137.5
interval = 0.002
meristem_area_mm2 = 8
meristem_growth = [[0, 1], [1, 2.5]]
area_mm2 = [[0.0, 0.5], [1.0, 1.0]]
receptacle_pigment = "green"
[[head.receptacle]]
time = 0.0
points = [[0.0, 2.0], [2.0, 2.0], [3.0, 1.5], [3.0, 0.0]]
[[head.zones]]
organ = "floret"
from = 0.0
to = 0.9
[[head.zones]]
organ = "bract"
from = 0.9
to = 1.0
[head.fate]
of = "floret"
with_room = "ray"
cone_deg = 70

[peduncle]
pigment = "green"
length_mm = 80.0

[organs.ray]
variants = 6
opening = [[0.0, 0.0], [0.5, 1.0]]
variation = { size = [0.9, 1.1], pitch_deg = [-3, 3] }
shape_variation = { curl_deg = [-10, 10] }
[[organs.ray.petals]]
name = "ligule"
pigment = "white"
mirrored = false
count = 1
[[organs.ray.petals.poses]]
stage = 0.0
midrib_mm = [[0, 0], [0, 1], [0, 2], [0, 3]]
half_width_mm = [0.5, 1, 1, 0.2]
section = [[0, 0], [0.5, 0.1], [1, 0]]
[[organs.ray.petals.poses]]
stage = 1.0
midrib_mm = [[0, 0], [1, 1], [4, 1], [9, 1]]
half_width_mm = [0.5, 1, 1, 0.2]
sections = [[[0, 0], [0.5, 0.1], [1, 0]], [[0, 0], [0.5, 0.1], [1, 0]], [[0, 0], [0.5, 0.1], [1, 0, 0.2]], [[0, 0], [0.5, 0.1], [1, 0]]]
[organs.floret]
[[organs.floret.columns]]
name = "tube"
pigment = "yellow"
[[organs.floret.columns.poses]]
stage = 0.0
profile_mm = [[0.2, 0.0], [0.3, 1.0], [0.3, 2.0], [0.0, 3.0]]
[organs.bract]
[[organs.bract.petals]]
name = "blade"
pigment = "green"
[[organs.bract.petals.poses]]
stage = 0.0
midrib_mm = [[0, 0], [0, 1], [0, 2], [0, 3]]
half_width_mm = [1, 1, 1, 0]

[pigments.white]
colour = [[0.0, "#ffffff"], [1.0, "#fff0f5"]]
underside = "#ffc0cb"
hue_deg = [-4, 4]
[pigments.yellow]
colour = "#ffd21f"
[pigments.green]
colour = "#3a6b22"
veins = 5
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// The error of the daisy's file with one text replaced.
std::string error_with(const std::string& from, const std::string& to) {
  const Expected<Species> species = read_species(replaced(kDaisy, from, to), "daisy.toml");
  return species ? "no error" : to_string(species.error());
}

std::string error_of(const std::string& text) {
  const Expected<Species> species = read_species(text, "daisy.toml");
  return species ? "no error" : to_string(species.error());
}

TEST(ReadSpecies, ReadsEveryKindOfKey) {
  const Expected<Species> read = read_species(kDaisy, "daisy.toml");
  ASSERT_TRUE(read) << to_string(read.error());
  const Species& daisy = *read;
  EXPECT_EQ(daisy.name, "daisy");
  EXPECT_EQ(daisy.latin, "Bellis perennis");
  EXPECT_EQ(daisy.head.divergence_deg, 137.5);
  EXPECT_EQ(daisy.head.meristem_area_mm2, 8.0);  // a whole number where a number is wanted
  EXPECT_EQ(daisy.head.meristem_growth, (FunctionPoints{{0.0, 1.0}, {1.0, 2.5}}));
  EXPECT_EQ(daisy.head.area_growth, Head{}.area_growth);  // left out
  ASSERT_EQ(daisy.head.zones.size(), 2u);
  EXPECT_EQ(daisy.head.zones[1].organ, "bract");
  ASSERT_TRUE(daisy.head.fate);
  EXPECT_EQ(daisy.head.fate->cone_deg, 70.0);
  EXPECT_EQ(daisy.peduncle.length_mm, 80.0);
  const OrganKind& ray = daisy.organs[0];
  EXPECT_EQ(ray.variants, 6);
  EXPECT_EQ(ray.variation.pitch_deg, (Range{-3.0, 3.0}));
  EXPECT_EQ(ray.shape.variation.curl_deg, (Range{-10.0, 10.0}));
  ASSERT_EQ(ray.shape.petals.at(0).poses.size(), 2u);
  EXPECT_EQ(ray.shape.petals[0].poses[0].sections.size(), 1u);
  EXPECT_EQ(ray.shape.petals[0].poses[1].sections.at(2).at(2).forward, 0.2);
  EXPECT_EQ(daisy.organs[1].shape.columns.at(0).poses.at(0).profile_mm.at(3), (Vec2{0.0, 3.0}));
  EXPECT_EQ(daisy.pigments[0].colour.at(1).at, 1.0);
  EXPECT_TRUE(daisy.pigments[0].underside);
  EXPECT_FALSE(daisy.pigments[0].margin);
  EXPECT_EQ(daisy.pigments[2].veins, 5);
  EXPECT_EQ(daisy.sha256, sha256(kDaisy));
}

TEST(ReadSpecies, KeepsTheFilesOrderOfOrgansAndPigments) {
  const Expected<Species> daisy = read_species(kDaisy, "daisy.toml");
  ASSERT_TRUE(daisy);
  std::vector<std::string> names;
  for (const OrganKind& organ : daisy->organs) {
    names.push_back(organ.name);
  }
  for (const Pigment& pigment : daisy->pigments) {
    names.push_back(pigment.name);
  }
  EXPECT_THAT(names, testing::ElementsAre("ray", "floret", "bract", "white", "yellow", "green"));
}

TEST(ReadSpecies, SaysWhereAndWhatIsWrong) {
  EXPECT_EQ(error_with("interval = 0.002", "interval = -0.4"),
            "daisy.toml:7:12: head.interval must be > 0 and at most 1, got -0.4");
  EXPECT_EQ(error_with("divergence_deg", "divergance_deg"),
            "daisy.toml:6:1: head.divergance_deg is not known; did you mean divergence_deg?");
  EXPECT_EQ(error_with("[peduncle]", "[stalk]"), "daisy.toml:28:2: stalk is not known");
  EXPECT_EQ(error_with("interval = 0.002", "interval = \"fast\""),
            "daisy.toml:7:12: head.interval must be a number, got \"fast\"");
  EXPECT_EQ(error_with("variants = 6", "variants = 6.5"),
            "daisy.toml:33:12: organs.ray.variants must be a whole number in [1, 64], got 6.5");
  EXPECT_EQ(error_with("mirrored = false", "mirrored = 1"),
            "daisy.toml:40:12: organs.ray.petals[0].mirrored must be true or false, got 1");
  EXPECT_EQ(error_with("#ffd21f", "yellow"),
            "daisy.toml:73:10: pigments.yellow.colour must be a colour \"#rrggbb\", got \"yellow\"");
  EXPECT_EQ(error_with("time = 0.0", ""), "daisy.toml:12:1: head.receptacle[0].time is missing");
  EXPECT_EQ(error_with("name = \"daisy\"", ""), "daisy.toml:1:1: name is missing");
  EXPECT_EQ(error_with("[[0, 1], [1, 2.5]]", "[[0, 1], [1]]"),
            "daisy.toml:9:28: head.meristem_growth[1] must be two numbers [x, y], got a list");
  EXPECT_EQ(error_with("[[0, 1], [1, 2.5]]", "[[0.5, 1], [0.25, 2.5]]"),
            "daisy.toml:9:31: head.meristem_growth[1][0] must be at least 0.5 as the one before it, got 0.25");
  EXPECT_EQ(error_with("pitch_deg = [-3, 3]", "pitch_deg = [3, -3]"),
            "daisy.toml:35:50: organs.ray.variation.pitch_deg[1] must be at least the lowest value 3, got -3");
}

TEST(ReadSpecies, PointsAtNamesThatDoNotExist) {
  EXPECT_EQ(
      error_with("organ = \"floret\"", "organ = \"florett\""),
      "daisy.toml:16:9: head.zones[0].organ must name one of the organs, got \"florett\"; did you mean \"floret\"?");
  EXPECT_EQ(error_with("with_room = \"ray\"", "with_room = \"sunbeam\""),
            "daisy.toml:25:13: head.fate.with_room must name one of the organs, got \"sunbeam\"");
  EXPECT_EQ(error_with("pigment = \"white\"", "pigment = \"whit\""),
            "daisy.toml:39:11: organs.ray.petals[0].pigment must name one of the pigments, got \"whit\"; did you mean "
            "\"white\"?");
}

TEST(ReadSpecies, PlacesWhatOnlyTheWholeSpeciesShows) {
  // check(Species) finds these; the reader adds the line.
  EXPECT_THAT(error_with("from = 0.9\n", "from = 0.95\n"), StartsWith("daisy.toml:"));
  EXPECT_THAT(error_with("half_width_mm = [0.5, 1, 1, 0.2]", "half_width_mm = [0.5, 1, 1]"),
              AllOf(StartsWith("daisy.toml:4"), HasSubstr("half_width_mm")));
}

TEST(ReadSpecies, RefusesNumbersThatAreNotAndNumbersTooLarge) {
  for (const std::string value : {"nan", "-nan", "inf", "-inf", "1e300", "-1", "9223372036854775807"}) {
    EXPECT_THAT(error_with("interval = 0.002", "interval = " + value),
                StartsWith("daisy.toml:7:12: head.interval must be > 0 and at most 1, got "))
        << value;
    EXPECT_THAT(error_with("[1.0, 1.0]]", "[1.0, " + value + "]]"),
                StartsWith("daisy.toml:10:31: head.area_mm2[1][1] must be > 0 and at most 1e+06, got "))
        << value;
  }
  EXPECT_THAT(error_with("interval = 0.002", "interval = 1e999"), StartsWith("daisy.toml:7:"));
  EXPECT_THAT(error_with("variants = 6", "variants = 99999999999999999999"), StartsWith("daisy.toml:33:"));
}

TEST(ReadSpecies, RefusesListsBeyondTheirLimit) {
  std::string points = "[[0, 1]";
  for (int i = 0; i < 300; ++i) {
    points += ", [1, 1]";
  }
  EXPECT_EQ(error_with("[[0, 1], [1, 2.5]]", points + "]"),
            "daisy.toml:9:19: head.meristem_growth must have 2 to 256 elements, got 301");
  std::string organs = kDaisy;
  for (int i = 0; i < 100; ++i) {
    organs += "[organs.o" + std::to_string(i) + "]\n";
  }
  EXPECT_THAT(error_of(organs), HasSubstr("organs must have 1 to 64 entries, got 103"));
}

TEST(ReadSpecies, GivesOneErrorForAnyTruncation) {
  const std::string whole = kDaisy;
  for (std::size_t size = 0; size < whole.size(); size += 3) {
    const Expected<Species> species = read_species(whole.substr(0, size), "daisy.toml");
    if (!species) {  // some cuts leave a whole, smaller species
      const std::string message = to_string(species.error());
      EXPECT_THAT(message, StartsWith("daisy.toml:"));
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }
  EXPECT_EQ(error_of(""), "daisy.toml:1:1: name is missing");
}

TEST(ReadSpecies, GivesOneErrorForBytesThatAreNoText) {
  std::string bytes;
  for (int i = 0; i < 4096; ++i) {
    bytes += static_cast<char>(i * 37 % 256);
  }
  const std::vector<std::string> inputs = {bytes,
                                           std::string(4096, '\0'),
                                           "\xff\xfe\x00n",
                                           "\x7f"
                                           "ELF\x02\x01\x01",
                                           "glTF\x02",
                                           std::string(5000, '\xc3')};
  for (const std::string& input : inputs) {
    const std::string message = error_of(input);
    EXPECT_THAT(message, StartsWith("daisy.toml:1:"));
    EXPECT_THAT(message, HasSubstr("is not TOML"));
    for (const char c : message) {
      EXPECT_GE(static_cast<unsigned char>(c), 0x20);
    }
  }
}

TEST(ReadSpecies, GivesOneErrorForNumbersAndBracketsGoneWrong) {
  // Some fail assertions of the parser underneath, which must not stop a program (seen in builds that have them).
  for (const char* text :
       {"a = 1e",   "a = 0x",     "a = 0b2",   "a = 1_",    "a = +_1",      "a = 1__0", "a = 1.",   "a = .1",
        "a = 1e+",  "a = +",      "a = inf_",  "a = 1e_5",  "a = 00",       "a = 0x_",  "a = 0x1p", "a = 1979-",
        "a = 07:3", "a = 1979-5", "a = [}",    "a = [",     "a = [}]xT1",   "a = {",    "a = {b",   "a = {b = 1,}",
        "[.]",      "[}]",        "[=]",       "[[}]]",     "[a",           "[[a]",     "a.",       "a",
        "=",        "a = \"",     "a = '''",   "a = \"\\u", "a = \"\\",     "a = 1 b",  "a = ]",    "]",
        "}",        "a = ,",      "a = [1 2]", "a = #",     "a = 1e999999_"}) {
    const std::string message = error_of(text);
    EXPECT_THAT(message, StartsWith("daisy.toml:1:")) << text;
    EXPECT_EQ(message.find('\n'), std::string::npos) << text;
  }
}

TEST(ReadSpecies, GivesOneErrorOrASpeciesWhateverBytesAreChanged) {
  constexpr std::string_view kBytes = "0123456789eExob_+-.:TZ infa,]}[{#\n\"'=\\\x80";
  for (std::uint64_t run = 0; run < 400; ++run) {
    std::string text = kDaisy;
    Rng rng(1, run, RandomPurpose::kTest);
    const auto below = [&](std::size_t count) {
      return static_cast<std::size_t>(rng.uniform() * static_cast<double>(count));
    };
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
      text[below(text.size())] = kBytes[below(kBytes.size())];
    }
    const Expected<Species> species = read_species(text, "daisy.toml");
    if (!species) {
      EXPECT_THAT(to_string(species.error()), StartsWith("daisy.toml:"));
    }
  }
}

std::string repeated(const std::string& part, int count) {
  std::string result;
  for (int i = 0; i < count; ++i) {
    result += part;
  }
  return result;
}

TEST(ReadSpecies, RefusesDeepNestingInAllItsForms) {
  EXPECT_EQ(error_of("name = " + repeated("[", 100000)), "daisy.toml:1:40: nests more than 32 values");
  EXPECT_THAT(error_of("name = " + repeated("{a=", 100000)), HasSubstr("nests more than 32 values"));
  EXPECT_THAT(error_of("[" + repeated("a.", 100000) + "a]"), HasSubstr("has a key of more than 16 parts"));
  EXPECT_THAT(error_of(repeated("\"a\" . ", 100000) + "a = 1"), HasSubstr("has a key of more than 16 parts"));
  EXPECT_THAT(error_of(repeated("a.", 15) + "a = 1"), HasSubstr("a is not known"));
}

TEST(ReadSpecies, DoesNotTakeBracketsAndDotsInTextsForNesting) {
  const std::string summary =
      "summary = \"" + repeated("[.", 100) + "\\\" " + repeated("{.", 100) + "\"  # " + repeated("[.", 100);
  EXPECT_EQ(error_with("summary = \"A lawn daisy.\"", summary), "no error");
  EXPECT_EQ(error_with("summary = \"A lawn daisy.\"", "summary = '''\n" + repeated("['\".\n", 100) + "'''"),
            "no error");
}

TEST(ReadSpecies, RefusesMoreThanItsLimitOfBytes) {
  const Expected<Species> species = read_species(std::string(kSpeciesFileLimit + 1, '#'), "daisy.toml");
  ASSERT_FALSE(species);
  EXPECT_EQ(species.error().code, ErrorCode::kTooLarge);
  EXPECT_EQ(to_string(species.error()), "daisy.toml: must be at most 1048576 bytes, got 1048577");
}

TEST(ReadSpecies, QuotesLongAndStrangeTextShort) {
  EXPECT_LT(error_of("\"" + std::string(100000, 'x') + "\" = 1").size(), 200u);
  EXPECT_THAT(error_of("\"na\\u001bme\" = 1"), HasSubstr("na?me is not known"));
  EXPECT_LT(error_with("\"#ffd21f\"", "\"" + std::string(100000, 'x') + "\"").size(), 200u);
}

TEST(ReadSpecies, HairsStandOnAPartOfTheirOrganOrOnTheStem) {
  const std::string hairy = replaced(
      replaced(kDaisy, "[organs.bract]\n",
               "[[organs.floret.hairs]]\non = \"tube\"\npigment = \"white\"\nalong = [0.5, 1]\n[organs.bract]\n"),
      "length_mm = 80.0\n", "length_mm = 80.0\n[[peduncle.hairs]]\npigment = \"white\"\nlength_mm = [0.5, 2]\n");
  const Expected<Species> read = read_species(hairy, "hairy.toml");
  ASSERT_TRUE(read) << to_string(read.error());
  ASSERT_EQ(read->organs[1].shape.hairs.size(), 1u);
  EXPECT_EQ(read->organs[1].shape.hairs[0].on, "tube");
  EXPECT_EQ(read->organs[1].shape.hairs[0].along, (Range{0.5, 1.0}));
  ASSERT_EQ(read->peduncle.hairs.size(), 1u);
  EXPECT_EQ(read->peduncle.hairs[0].length_mm, (Range{0.5, 2.0}));
  const Expected<Species> again = read_species(write_species(*read), "again.toml");
  ASSERT_TRUE(again) << to_string(again.error());
  EXPECT_EQ(again->organs[1].shape.hairs[0].along, (Range{0.5, 1.0}));
  EXPECT_EQ(again->peduncle.hairs[0].length_mm, (Range{0.5, 2.0}));

  const auto error_with = [&](const std::string& from, const std::string& to) {
    const Expected<Species> spoilt = read_species(replaced(hairy, from, to), "hairy.toml");
    return spoilt ? "no error" : to_string(spoilt.error());
  };
  EXPECT_EQ(error_with("on = \"tube\"", "on = \"tub\""),
            "hairy.toml:63:6: organs.floret.hairs[0].on must name petals or a column of the same organ, got \"tub\"; "
            "did you mean \"tube\"?");
  EXPECT_EQ(error_with("[[peduncle.hairs]]\n", "[[peduncle.hairs]]\non = \"stem\"\n"),
            "hairy.toml:32:6: peduncle.hairs[0].on must be left out: they stand on the stem, got stem");
  EXPECT_EQ(error_with("along = [0.5, 1]", "along = [0.5, 1]\nlower = true"),
            "hairy.toml:66:9: organs.floret.hairs[0].lower must be false on a column, which has only an outside, got "
            "true");
}

TEST(WriteSpecies, ReadsBackAsTheSameSpecies) {
  const Expected<Species> daisy = read_species(kDaisy, "daisy.toml");
  ASSERT_TRUE(daisy);
  const std::string text = write_species(*daisy);
  const Expected<Species> again = read_species(text, "again.toml");
  ASSERT_TRUE(again) << to_string(again.error()) << '\n' << text;
  EXPECT_EQ(write_species(*again), text);
  EXPECT_EQ(again->organs[0].shape.petals[0].poses[1].midrib_mm, daisy->organs[0].shape.petals[0].poses[1].midrib_mm);
  EXPECT_EQ(again->pigments[0].underside, daisy->pigments[0].underside);
  EXPECT_EQ(again->head.meristem_growth, daisy->head.meristem_growth);
  EXPECT_THAT(text, HasSubstr("variation = { size = [0.9, 1.1], pitch_deg = [-3, 3] }\n"));
  EXPECT_THAT(text, testing::Not(HasSubstr("area_growth")));  // equals its default
}

TEST(WriteSpecies, WritesEveryKeyThatDiffersFromItsDefault) {
  // Each line of the daisy that states something else than the default is in the written file as well.
  Expected<Species> daisy = read_species(kDaisy, "daisy.toml");
  ASSERT_TRUE(daisy);
  daisy->summary = "Quotes \" and \\ and\ttabs, and ünïcode.";
  daisy->peduncle.bend_deg = -12.5;
  daisy->organs[1].shape.columns[0].sides = 12;
  daisy->pigments[1].margin = Colour{1.0, 0.0, 0.0};
  daisy->head.fate.reset();
  const Expected<Species> again = read_species(write_species(*daisy), "again.toml");
  ASSERT_TRUE(again) << to_string(again.error());
  EXPECT_EQ(again->summary, daisy->summary);
  EXPECT_EQ(again->peduncle.bend_deg, -12.5);
  EXPECT_EQ(again->organs[1].shape.columns[0].sides, 12);
  EXPECT_EQ(again->pigments[1].margin, (Colour{1.0, 0.0, 0.0}));
  EXPECT_FALSE(again->head.fate);
}

TEST(SpeciesSchema, DescribesEveryKeyWithARangeAndASentence) {
  const nlohmann::json schema = nlohmann::json::parse(species_schema());
  const auto& head = schema["properties"]["head"]["properties"];
  EXPECT_EQ(head["interval"]["exclusiveMinimum"], 0.0);
  EXPECT_EQ(head["interval"]["maximum"], 1.0);
  EXPECT_EQ(head["divergence_deg"]["default"], Head{}.divergence_deg);
  EXPECT_EQ(schema["additionalProperties"], false);
  EXPECT_EQ(schema["properties"]["organs"]["additionalProperties"]["additionalProperties"], false);
  EXPECT_THAT(schema["required"], testing::Contains("head"));
  for (const auto& [key, value] : head.items()) {
    EXPECT_FALSE(value["description"].get<std::string>().empty()) << key;
  }
}

TEST(BuiltinSpecies, AreTheFilesOfTheSpeciesFolderAndAllRead) {
  ASSERT_FALSE(builtin_species().empty());
  for (const BuiltinSpecies& builtin : builtin_species()) {
    const std::string path = std::string(ANTHESIS_SOURCE_DIR "/species/") + std::string(builtin.name) + ".toml";
    std::ifstream file(path, std::ios::binary);
    EXPECT_EQ(builtin.text, std::string(std::istreambuf_iterator<char>(file), {})) << path;
    const Expected<Species> species = find_species(std::string(builtin.name));
    ASSERT_TRUE(species) << to_string(species.error());
    EXPECT_EQ(species->name, builtin.name);
    const Expected<Species> again = read_species(write_species(*species), "again.toml");
    ASSERT_TRUE(again) << to_string(again.error());
    EXPECT_EQ(write_species(*again), write_species(*species));
  }
}

TEST(BuiltinSpecies, SchemaBesideThemIsTheOneOfThisVersion) {
  std::ifstream file(ANTHESIS_SOURCE_DIR "/species/species.schema.json", std::ios::binary);
  EXPECT_TRUE(species_schema() == std::string(std::istreambuf_iterator<char>(file), {}))
      << "renew it: build/bin/anthesis species --schema > species/species.schema.json";
}

TEST(FindSpecies, TakesNamesAndPathsAndHintsAtNames) {
  ASSERT_FALSE(builtin_species().empty());
  const std::string name(builtin_species().front().name);
  const Expected<Species> misspelt = find_species(name + "s");
  ASSERT_FALSE(misspelt);
  EXPECT_EQ(misspelt.error().code, ErrorCode::kUnknownParameter);
  EXPECT_EQ(to_string(misspelt.error()), "there is no species \"" + name + "s\"; did you mean " + name + "?");
  const Expected<Species> absent = find_species("./nowhere/daisy.toml");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().code, ErrorCode::kIo);
}

TEST(ReadSpecies, LettersBeyondAsciiAreForTextsAndComments) {
  const auto error_of = [](const char* text) { return to_string(read_species(text, "a.toml").error()); };
  EXPECT_EQ(error_of("name = \"x\"\nl\u00e4nge = 1\n"),
            "a.toml:2:2: is not TOML: characters beyond ASCII stand in quoted texts and comments only");
  EXPECT_EQ(error_of("name = \u00e9"),
            "a.toml:1:8: is not TOML: characters beyond ASCII stand in quoted texts and comments only");
  // In a text, in a comment and as a byte order mark they are nobody's fault.
  EXPECT_EQ(error_of("\xEF\xBB\xBF# \u00e9\nsummary = \"\u00e9\"\nnmae = \"x\"\n").find("beyond ASCII"),
            std::string::npos);
}

}  // namespace
}  // namespace anthesis
