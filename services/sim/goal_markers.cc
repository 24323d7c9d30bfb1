#include "sim/goal_markers.h"

#include "common/protocol/convert.h"

namespace conav::sim {
namespace {

constexpr std::int32_t kSphere = 2;  // visualization_msgs/Marker SPHERE
constexpr std::int32_t kAdd = 0;
constexpr std::int32_t kDelete = 2;

float Channel(std::uint8_t value) { return static_cast<float>(value) / 255.0F; }

}  // namespace

visualization_msgs::msg::MarkerArray GoalMarkers(const Episode& episode) {
  const PhysicsWorld& world = episode.physics().world();
  const double diameter = 2.0 * GoalRadius(world.cell_size_m);
  visualization_msgs::msg::MarkerArray array;
  for (std::size_t i = 0; i < world.goals.size(); ++i) {
    const GoalSpec& goal = world.goals[i];
    const Rgb rgb = kGoalColors[goal.color_index % kGoalColorCount];
    const Position position = episode.physics().geometry().CellToPosition(goal.cell);
    visualization_msgs::msg::Marker marker;
    marker.header().frame_id("map");
    marker.header().stamp(ToMessage(episode.now()));
    marker.ns("goals");
    marker.id(static_cast<std::int32_t>(i));
    marker.type(kSphere);
    marker.action(episode.physics().goal_visible(static_cast<int>(i)) ? kAdd : kDelete);
    marker.pose().position().x(position.x_m);
    marker.pose().position().y(position.y_m);
    marker.pose().orientation().w(1.0);
    marker.scale().x(diameter);
    marker.scale().y(diameter);
    marker.scale().z(diameter);
    marker.color().r(Channel(rgb.red));
    marker.color().g(Channel(rgb.green));
    marker.color().b(Channel(rgb.blue));
    marker.color().a(1.0F);
    array.markers().push_back(std::move(marker));
  }
  return array;
}

}  // namespace conav::sim
