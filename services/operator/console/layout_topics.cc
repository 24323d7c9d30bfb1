#include "operator/console/layout_topics.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "common/bus/topics.h"
#include "common/runtime/clock.h"
#include "common/runtime/result.h"
#include "common/runtime/text.h"
#include "common/service/diagnostics.h"

namespace conav::operators {
namespace {

constexpr int kInnerCells = 6;
constexpr int kFrameCells = 2;  // black and white
constexpr int kMostAreas = 64;
constexpr std::size_t kLongestName = 64;
constexpr double kMostPixels = 1e6;

bool IsPosition(double value) { return std::abs(value) <= kMostPixels; }  // false for NaN
bool IsName(const std::string& text) { return text.size() <= kLongestName && IsPlainName(text); }

bool IsArea(const console::PageArea& area) {
  return IsName(area.name()) && (area.robot().empty() || IsName(area.robot())) &&
         IsPosition(area.x()) && IsPosition(area.y()) && IsPosition(area.width()) &&
         IsPosition(area.height()) && area.width() >= 0.0 && area.height() >= 0.0;
}

bool IsLayout(const console::PageLayout& layout) {
  const auto are_areas = [](const auto& areas) {
    return areas.size() <= kMostAreas && std::ranges::all_of(areas, IsArea);
  };
  const bool is_page = layout.width() > 0.0 && layout.width() <= kMostPixels &&
                       layout.height() > 0.0 && layout.height() <= kMostPixels &&
                       layout.pixel_ratio() > 0.0 && layout.pixel_ratio() <= 100.0;
  const bool is_map = (layout.world().empty() || IsName(layout.world())) &&
                      IsPosition(layout.map_x()) && IsPosition(layout.map_y()) &&
                      IsPosition(layout.map_dx()) && IsPosition(layout.map_dy());
  return is_page && is_map && are_areas(layout.areas()) && are_areas(layout.tags());
}

void AddAreas(const google::protobuf::RepeatedPtrField<console::PageArea>& areas,
              std::vector<conav_msgs::msg::PageArea>& to) {
  for (const console::PageArea& area : areas) {
    auto& added = to.emplace_back();
    added.name(area.name());
    added.robot(area.robot());
    added.x(area.x());
    added.y(area.y());
    added.width(area.width());
    added.height(area.height());
  }
}

}  // namespace

std::vector<std::uint64_t> TagPatterns() {
  const std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)> family(tag36h11_create(),
                                                                                tag36h11_destroy);
  DEMAND(family->total_width == kInnerCells + 2 * kFrameCells, family->total_width);
  std::vector<std::uint64_t> patterns;
  for (int id = 0; id < kPageTags; ++id) {
    const std::unique_ptr<image_u8_t, void (*)(image_u8_t*)> image(
        apriltag_to_image(family.get(), id), image_u8_destroy);
    std::uint64_t pattern = 0;
    for (int row = 0; row < kInnerCells; ++row) {
      for (int column = 0; column < kInnerCells; ++column) {
        const int at = (row + kFrameCells) * image->stride + column + kFrameCells;
        pattern = 2 * pattern + (image->buf[at] > 0 ? 1 : 0);
      }
    }
    patterns.push_back(pattern);
  }
  return patterns;
}

LayoutTopics::LayoutTopics(bus::Participant& participant, const TaskOptions& task)
    : publisher_(participant, bus::kPageLayout), refusals_logged_(std::chrono::seconds(10)) {
  if (task.tags) tags_ = TagPatterns();
}

void LayoutTopics::AddTags(console::Task& task) const {
  for (const std::uint64_t pattern : tags_) task.add_tags(pattern);
}

void LayoutTopics::Publish(const std::string& client, const console::PageLayout& layout) {
  if (!IsLayout(layout)) {
    if (refusals_logged_.Allow()) LOG_WARNING("layout of a page refused", "client", client);
    return;
  }
  conav_msgs::msg::PageLayout message;
  const double now_s = WallSeconds();
  message.header().stamp(RosWallTime(Seconds(now_s)));
  message.utc(now_s);
  message.client(client);
  message.width(layout.width());
  message.height(layout.height());
  message.pixel_ratio(layout.pixel_ratio());
  AddAreas(layout.areas(), message.areas());
  AddAreas(layout.tags(), message.tags());
  message.world(layout.world());
  message.map_x(layout.map_x());
  message.map_y(layout.map_y());
  message.map_dx(layout.map_dx());
  message.map_dy(layout.map_dy());
  bus::Send(publisher_, message);
}

}  // namespace conav::operators
