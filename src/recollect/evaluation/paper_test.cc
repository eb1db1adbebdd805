#include "recollect/evaluation/paper.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/evaluation/html_report.h"
#include "recollect/evaluation/thumbnails.h"
#include "recollect/testing/scratch_folder.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

TEST(RunPaper, AsksBeforeAnyWork) {
  std::vector<Lap> laps(2);
  laps[0].name = "a";
  laps[1].name = "b";
  PaperOptions options;
  const testing::ScratchFolder folder;
  options.out = folder / "out";
  EXPECT_THROW(RunPaper(laps, options), Error);  // rendered or real?
  options.images = "real";
  EXPECT_THROW(RunPaper(laps, options), Error);  // no images
  options.laps.test = "c";
  EXPECT_THROW(RunPaper(laps, options), Error);  // no such lap
  EXPECT_FALSE(fs::exists(options.out));
}

TEST(ReadCurve, TakesTheTrainersFilesOldAndNew) {
  const testing::ScratchFolder folder;
  const fs::path file = folder / "curve.csv";
  AtomicWrite(file, "step,epoch,loss,valid_position_m\n100,0.1,4,2.5\n200,0.2,3,2\n");
  const auto old = ReadCurve(file);
  ASSERT_EQ(old.size(), 2u);
  EXPECT_EQ(old[1].step, 200);
  EXPECT_EQ(old[1].valid_position_m, 2);
  EXPECT_TRUE(std::isnan(old[1].train_position_m));
  AtomicWrite(file, "step,loss,valid_position_m,train_position_m\n100,4,2.5,2.25\n");
  EXPECT_EQ(ReadCurve(file).at(0).train_position_m, 2.25);
  AtomicWrite(file, "step,loss\n100,4\n");
  EXPECT_THROW(ReadCurve(file), Error);
  AtomicWrite(file, "step,loss,valid_position_m\n100,4\n");
  EXPECT_THROW(ReadCurve(file), Error);
}

TEST(Thumbnail, FitsIntoItsBytes) {
  EXPECT_EQ(Base64({}), "");
  EXPECT_EQ(Base64({'M'}), "TQ==");
  EXPECT_EQ(Base64({'M', 'a'}), "TWE=");
  EXPECT_EQ(Base64({'M', 'a', 'n'}), "TWFu");
  EXPECT_EQ(Base64({0xfb, 0xff}), "+/8=");
  cv::Mat noise(480, 640, CV_8UC3);
  cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 256);
  EXPECT_LE(Thumbnail(noise, 3000).size(), 4000u);
  EXPECT_GT(Thumbnail(noise, 3000).size(), 1000u);
  EXPECT_THROW(Thumbnail(cv::Mat(), 3000), Error);
  EXPECT_EQ(BytesAnImage(1000, 4'000'000), 3000u);
}

TEST(WriteHtmlReport, PutsDataWhereThePageLooksForThem) {
  const testing::ScratchFolder folder;
  const fs::path page = folder / "template.html", file = folder / "report.html";
  const std::string empty =
      "<script id=\"report-data\">null</script><script id=\"report-images\">null</script>";
  AtomicWrite(page, empty);
  WriteHtmlReport({{"command", "a </script> b"}}, {{"live", {"x"}}}, page, file);
  EXPECT_EQ(ReadFile(file),
            "<script id=\"report-data\">{\"command\":\"a \\u003c/script> b\"}</script>"
            "<script id=\"report-images\">{\"live\":[\"x\"]}</script>");
  AtomicWrite(page, "<html>");
  EXPECT_THROW(WriteHtmlReport({}, {}, page, file), Error);
  fs::remove(page);
  try {
    WriteHtmlReport({}, {}, page, file);
    FAIL() << "took a page that is not there";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("npm"), std::string::npos);
  }
}

}  // namespace
}  // namespace recollect
