// Finding modules: good ones are offered, broken ones are one line each and harm nobody.
#include "technique/catalogue.h"
#include "volmark/error.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>

namespace volmark {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

std::filesystem::path modules(const std::string& name) {
  return std::filesystem::path(VOLMARK_BINARY_DIR) / "harness" / "tests" / "technique" / "modules" / name;
}

std::vector<std::string> namesOf(const TechniqueCatalogue& catalogue) {
  std::vector<std::string> names;
  for (const CatalogueEntry& entry : catalogue.entries())
    names.push_back(entry.factory->info.name);
  return names;
}

TEST(Catalogue, OffersTheTechniquesOfAModuleByName) {
  const TechniqueCatalogue catalogue({modules("good")});
  EXPECT_THAT(catalogue.problems(), IsEmpty());
  EXPECT_THAT(namesOf(catalogue), ElementsAre("ant", "zebra"));
  const CatalogueEntry& ant = catalogue.get("ant");
  EXPECT_EQ(ant.family, "test_module");
  EXPECT_EQ(ant.module.filename(), "test_good.so");
  EXPECT_EQ(ant.moduleDigest.size(), 32u);
  EXPECT_NE(ant.factory->create(), nullptr);
}

TEST(Catalogue, DigestIsOfTheFilesContent) {
  const TechniqueCatalogue first({modules("good")}), again({modules("good")}), other({modules("second")});
  EXPECT_EQ(first.get("ant").moduleDigest, again.get("ant").moduleDigest);
  EXPECT_NE(first.get("zebra").moduleDigest, other.get("zebra").moduleDigest);
}

TEST(Catalogue, TheFirstOfTwoTechniquesOfOneNameStays) {
  const TechniqueCatalogue catalogue({modules("second"), modules("good")});
  EXPECT_THAT(namesOf(catalogue), ElementsAre("ant", "bee", "zebra"));
  EXPECT_EQ(catalogue.get("zebra").module.filename(), "test_second.so");
  EXPECT_THAT(catalogue.problems(),
              ElementsAre(AllOf(HasSubstr("test_good.so: technique \"zebra\" is already offered by"),
                                HasSubstr("test_second.so"))));
}

struct Refused {
  std::string module, text;
};

class RefusedModules : public ::testing::TestWithParam<Refused> {};

TEST_P(RefusedModules, AreOneLineAndTheOthersWork) {
  const TechniqueCatalogue catalogue({modules(GetParam().module), modules("good")});
  EXPECT_THAT(namesOf(catalogue), ElementsAre("ant", "zebra"));
  EXPECT_THAT(catalogue.problems(), ElementsAre(AllOf(HasSubstr("test_" + GetParam().module + ".so: "),
                                                      HasSubstr(GetParam().text), Not(HasSubstr("\n")))));
}

INSTANTIATE_TEST_SUITE_P(
    Catalogue, RefusedModules,
    ::testing::Values(Refused{"no_entry", "volmarkModule"},
                      Refused{"magic", "found module format 0x00000007, expected 0x766d6b01"},
                      Refused{"sdk_version", std::string("built for SDK version \"0.0.9\", expected \"") + kSdkVersion},
                      Refused{"compiler", std::string("built for compiler \"Other 1.0\", expected \"") + kCompiler},
                      Refused{"build_id", std::string("\"0123456789abcdef\", expected \"") + kBuildId},
                      Refused{"null_id", std::string("built for SDK build \"\", expected \"") + kBuildId}),
    [](const auto& row) { return row.param.module; });

TEST(Catalogue, RefusesFilesThatAreNoLibraries) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "volmark_no_modules";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "garbage.so") << "not a library";
  std::ofstream(folder / "notes.txt") << "not looked at";
  const TechniqueCatalogue catalogue({folder});
  EXPECT_THAT(catalogue.problems(), ElementsAre(AllOf(HasSubstr("garbage.so: can't be loaded"), Not(HasSubstr("\n")))));
  std::filesystem::remove_all(folder);
}

TEST(Catalogue, SaysThatAFolderIsMissing) {
  EXPECT_THAT(TechniqueCatalogue({"/nowhere"}).problems(), ElementsAre(HasSubstr("/nowhere: can't be searched")));
}

std::string errorOf(const TechniqueCatalogue& catalogue, const std::string& name) {
  try {
    catalogue.get(name);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Catalogue, NamesTheNearestTechnique) {
  const TechniqueCatalogue catalogue({modules("good")});
  EXPECT_EQ(errorOf(catalogue, "zebrra"), "unknown technique \"zebrra\", did you mean \"zebra\"? allowed: ant, zebra");
  EXPECT_EQ(errorOf(catalogue, "rhinoceros"), "unknown technique \"rhinoceros\", allowed: ant, zebra");
}

TEST(Catalogue, SaysWhyItIsEmpty) {
  EXPECT_THAT(errorOf(TechniqueCatalogue(), "ant"), HasSubstr("no modules found"));
  EXPECT_THAT(errorOf(TechniqueCatalogue({modules("magic")}), "ant"), HasSubstr("found module format"));
}

TEST(TechniqueFolders, BeginWithTheVariable) {
  setenv("VOLMARK_TECHNIQUES", "/a:/b::/c", 1);
  const auto folders = techniqueFolders();
  unsetenv("VOLMARK_TECHNIQUES");
  ASSERT_GE(folders.size(), 3u);
  EXPECT_EQ(folders[0], "/a");
  EXPECT_EQ(folders[1], "/b");
  EXPECT_EQ(folders[2], "/c");
  for (const auto& folder : techniqueFolders())
    EXPECT_TRUE(std::filesystem::is_directory(folder));
}

} // namespace
} // namespace volmark
