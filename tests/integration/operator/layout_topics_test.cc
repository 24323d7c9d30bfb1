#include "operator/console/layout_topics.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
#include <google/protobuf/text_format.h>

#include <catch2/catch.hpp>

#include "common/bus/in_memory_bus.h"
#include "common/bus/subscriber.h"
#include "common/bus/topics.h"
#include "common/runtime/clock.h"

namespace conav::operators {
namespace {

console::PageLayout LayoutOf(const std::string& text) {
  console::PageLayout layout;
  REQUIRE(google::protobuf::TextFormat::ParseFromString(text, &layout));
  return layout;
}

constexpr const char* kPage = "width: 800 height: 600 pixel_ratio: 2 ";

TEST_CASE("where a page shows what is published with its client and the time", "[operator][task]") {
  auto shared = std::make_shared<bus::InMemoryBus>();
  bus::Participant participant("operator", shared);
  bus::Participant other("recorder", shared);
  bus::Subscriber<conav_msgs::msg::PageLayout> subscriber(other, bus::kPageLayout);
  LayoutTopics topics(participant, {});
  topics.Publish("anna/1",
                 LayoutOf(std::string(kPage) +
                          "areas { name: 'map' x: 1 y: 2 width: 3 height: 4 } "
                          "areas { name: 'picture' robot: 'r1' x: 5 y: 6 width: 7 height: 8 } "
                          "tags { name: 'tag0' x: 12 y: 13 width: 96 height: 97 } "
                          "world: 'w1' map_x: 10 map_y: 11 map_dx: 16 map_dy: 17"));
  const auto layouts = subscriber.Take();
  REQUIRE(layouts.size() == 1);
  const auto& layout = layouts.front();
  CHECK(std::abs(layout.utc() - WallSeconds()) < 60.0);
  CHECK(layout.client() == "anna/1");
  CHECK(layout.width() == 800.0);
  CHECK(layout.height() == 600.0);
  CHECK(layout.pixel_ratio() == 2.0);
  REQUIRE(layout.areas().size() == 2);
  CHECK(layout.areas()[0].name() == "map");
  CHECK(layout.areas()[0].height() == 4.0);
  CHECK(layout.areas()[1].robot() == "r1");
  REQUIRE(layout.tags().size() == 1);
  CHECK(layout.tags()[0].x() == 12.0);
  CHECK(layout.tags()[0].y() == 13.0);
  CHECK(layout.tags()[0].width() == 96.0);
  CHECK(layout.world() == "w1");
  CHECK(layout.map_x() == 10.0);
  CHECK(layout.map_y() == 11.0);
  CHECK(layout.map_dx() == 16.0);
  CHECK(layout.map_dy() == 17.0);
}

TEST_CASE("a layout that cannot be is not published", "[operator][task]") {
  auto shared = std::make_shared<bus::InMemoryBus>();
  bus::Participant participant("operator", shared);
  bus::Participant other("recorder", shared);
  bus::Subscriber<conav_msgs::msg::PageLayout> subscriber(other, bus::kPageLayout);
  LayoutTopics topics(participant, {});
  console::PageLayout many = LayoutOf(kPage);
  for (int i = 0; i < 100; ++i) many.add_areas()->set_name("map");
  topics.Publish("anna/1", many);
  CHECK(subscriber.Take().empty());
  for (const char* more : {"width: nan", "height: -1", "pixel_ratio: -1", "map_x: inf",
                           "areas { name: 'map' x: nan }", "areas { name: 'map' width: -1 }",
                           "areas { name: 'a/b' }", "tags { x: 1e9 }", "world: 'a\\nb'"}) {
    console::PageLayout layout = LayoutOf(kPage);
    layout.MergeFrom(LayoutOf(more));
    CAPTURE(more);
    topics.Publish("anna/1", layout);
    CHECK(subscriber.Take().empty());
  }
}

/// The pattern as a page draws it: 12 pixels a cell, with its black and its white frame, on grey.
std::vector<std::uint8_t> Drawn(std::uint64_t pattern, int size) {
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(size * size), 128);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 120; ++x) {
      const int row = y / 12 - 2;
      const int column = x / 12 - 2;
      const bool is_inner = row >= 0 && row < 6 && column >= 0 && column < 6;
      const bool is_frame = y < 12 || x < 12 || y >= 108 || x >= 108;
      const bool is_white = is_inner ? ((pattern >> (35 - 6 * row - column)) & 1U) == 1U : is_frame;
      pixels[static_cast<std::size_t>((y + 40) * size + x + 40)] = is_white ? 255 : 0;
    }
  }
  return pixels;
}

TEST_CASE("the tags are those that AprilTag's own detector finds", "[operator][task]") {
  const TaskOptions with_tags{.tags = true};
  auto shared = std::make_shared<bus::InMemoryBus>();
  bus::Participant participant("operator", shared);
  console::Task task;
  LayoutTopics(participant, {}).AddTags(task);
  CHECK(task.tags_size() == 0);
  LayoutTopics(participant, with_tags).AddTags(task);
  REQUIRE(task.tags_size() == kPageTags);
  apriltag_family_t* family = tag36h11_create();
  apriltag_detector_t* detector = apriltag_detector_create();
  apriltag_detector_add_family(detector, family);
  constexpr int kSize = 200;
  for (int id = 0; id < kPageTags; ++id) {
    std::vector<std::uint8_t> pixels = Drawn(task.tags(id), kSize);
    image_u8_t image{.width = kSize, .height = kSize, .stride = kSize, .buf = pixels.data()};
    zarray_t* found = apriltag_detector_detect(detector, &image);
    REQUIRE(zarray_size(found) == 1);
    apriltag_detection_t* tag = nullptr;
    zarray_get(found, 0, static_cast<void*>(&tag));
    CHECK(tag->id == id);
    CHECK(tag->hamming == 0);
    CHECK(tag->c[0] == Approx(100.0).margin(1.0));  // the middle of 40 + 12 to 40 + 108
    CHECK(tag->c[1] == Approx(100.0).margin(1.0));
    apriltag_detections_destroy(found);
  }
  apriltag_detector_destroy(detector);
  tag36h11_destroy(family);
}

}  // namespace
}  // namespace conav::operators
