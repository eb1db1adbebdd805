#include "recollect/evaluation/artefacts.h"

#include <gtest/gtest.h>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/evaluation/data_hash.h"
#include "recollect/testing/scratch_folder.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class ArtefactsTest : public ::testing::Test {
 protected:
  // Does one step that counts how often it is done, and leaves a file.
  json Do(const RunStamp& stamp, const json& inputs = {{"spacing", 5}}) {
    Artefacts artefacts(folder_.path(), stamp);
    return artefacts.Step("map", inputs,
                          [&] {
                            AtomicWrite(artefacts.Path("map.bin"), "bytes");
                            return json{{"done", ++done_}};
                          },
                          {"map.bin"});
  }

  const testing::ScratchFolder folder_;
  RunStamp stamp_{"recollect x", 1, {{"recollect", "0.1"}}, "abc"};
  int done_ = 0;
};

TEST_F(ArtefactsTest, AreTakenAgainWhereTheStampAgrees) {
  EXPECT_EQ(Do(stamp_)["done"], 1);
  EXPECT_EQ(Do(stamp_)["done"], 1);
  stamp_.command = "the same, typed otherwise";
  EXPECT_EQ(Do(stamp_)["done"], 1);
  const json file = json::parse(ReadFile(folder_ / "map.json"));
  EXPECT_EQ(file["stamp"]["command"], "recollect x");
  EXPECT_EQ(file["stamp"]["data_hash"], "abc");
}

TEST_F(ArtefactsTest, AreMadeAnewWhereAnythingDiffers) {
  Do(stamp_);
  stamp_.seed = 2;
  EXPECT_EQ(Do(stamp_)["done"], 2);
  stamp_.data_hash = "abd";
  EXPECT_EQ(Do(stamp_)["done"], 3);
  stamp_.versions["recollect"] = "0.2";
  EXPECT_EQ(Do(stamp_)["done"], 4);
  EXPECT_EQ(Do(stamp_, {{"spacing", 6}})["done"], 5);
}

TEST_F(ArtefactsTest, AreMadeAnewWhereFilesAreGoneOrChanged) {
  Do(stamp_);
  fs::remove(folder_ / "map.bin");
  EXPECT_EQ(Do(stamp_)["done"], 2);
  AtomicWrite(folder_ / "map.bin", "bytez");
  EXPECT_EQ(Do(stamp_)["done"], 3);
  AtomicWrite(folder_ / "map.json", "{\"key\": \"cut sh");
  EXPECT_EQ(Do(stamp_)["done"], 4);
}

TEST(Hash, IsFnv1a) {
  EXPECT_EQ(Hash().Text(), "cbf29ce484222325");  // of nothing, as the algorithm is published
  EXPECT_EQ(Hash().Add("a").Text(), "af63dc4c8601ec8c");
  EXPECT_EQ(Hash().Add("foo").Add("bar").Text(), "85944171f73967e8");
  EXPECT_THROW(HashOfFile("no/such/file"), Error);
}

TEST_F(ArtefactsTest, NothingIsLeftOfAStepThatFails) {
  Artefacts artefacts(folder_.path(), stamp_);
  EXPECT_THROW(artefacts.Step("map", {}, []() -> json { throw std::runtime_error("no"); }, {}),
               std::runtime_error);
  EXPECT_FALSE(fs::exists(folder_ / "map.json"));
}

}  // namespace
}  // namespace recollect
