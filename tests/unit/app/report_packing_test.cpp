#include <gtest/gtest.h>

#include <regex>

#include "app/report/figures.hpp"
#include "app/report/page_figure.hpp"

namespace grainlaw::app::report {
namespace {

dem::ShearPictures pictures() {
  dem::PackingPicture picture{10, 10, {{5, 5, 1}, {7, 5, 1}}, {}, {}, {}};
  picture.count.assign(dem::kRoseBins, 1);
  picture.force.assign(dem::kRoseBins, 1);
  dem::ShearPictures all{"D2-<b>-s1", 0.74, 0.26, 2, "x", "z", picture, picture};
  all.after.width = 12;
  all.after.height = 8;
  return all;
}

std::size_t count_of(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  return static_cast<std::size_t>(std::distance(std::sregex_iterator(text.begin(), text.end(), regex), {}));
}

TEST(PackingDrawing, LengthsAreToOneScale) {
  const Drawing drawing = packing_drawing(pictures());
  ASSERT_EQ(drawing.panels.size(), 4u);
  // 450 px are the wider one's 12 radii: 37.5 px each, the first in the middle of 470 px
  EXPECT_EQ(count_of(drawing.panels[0], "<circle cx=\"235.0\" cy=\"211.5\" r=\"37.5\"/>"), 1u) << drawing.panels[0];
  EXPECT_EQ(count_of(drawing.panels[1], "<circle cx=\"197.5\" cy=\"136.5\" r=\"37.5\"/>"), 1u) << drawing.panels[1];
}

TEST(PackingDrawing, ChainsAreAsWideAsTheirForce) {
  dem::ShearPictures all = pictures();
  all.before.chains = {{1, 1, 2, 1, 0.2}, {1, 2, 2, 2, 0.3}, {1, 3, 2, 3, 0.4}, {1, 4, 2, 4, 1.3}, {1, 5, 2, 5, 9}};
  const std::string svg = packing_drawing(all).panels[0];
  std::vector<std::size_t> lines;  // of each width
  const std::regex path("<path class=\"k[12] l\" [^>]* d=\"([^\"]*)\"/>");
  for (std::sregex_iterator at(svg.begin(), svg.end(), path), end; at != end; ++at)
    lines.push_back(count_of((*at)[1].str(), "m"));
  EXPECT_EQ(lines, (std::vector<std::size_t>{2, 0, 1, 0, 0, 1}));  // the weakest is not drawn
}

TEST(PackingDrawing, TheCaptionSaysHowManyMoreContactsBearOnTheCompressedAxis) {
  dem::ShearPictures all = pictures();
  for (const std::size_t bin : {7u, 8u, 9u, 10u}) all.after.count[bin] = 1.5;
  for (const std::size_t bin : {0u, 1u, 16u, 17u}) all.after.force[bin] = 0.5;
  all.note = "Said beneath.";
  const Drawing drawing = packing_drawing(all);
  const std::string caption = to_plain(drawing.caption);
  EXPECT_TRUE(caption.ends_with(" Said beneath.")) << caption;
  EXPECT_NE(caption.find("1.50 times as many contacts as along the extended one after shear (1.00 before)"),
            std::string::npos)
      << caption;
  EXPECT_NE(caption.find("2.00 times the force (1.00)"), std::string::npos) << caption;
  EXPECT_EQ(drawing_html(drawing).find("D2-<b>"), std::string::npos);
}

TEST(PackingDrawing, WithoutContactsThereAreNoRoses) {
  dem::ShearPictures all = pictures();
  all.before.count.clear();
  all.before.force.clear();
  EXPECT_EQ(packing_drawing(all).panels.size(), 2u);
}

}  // namespace
}  // namespace grainlaw::app::report
