#include "launcher/demo_world.h"

#include <fmt/format.h>

#include "sim/world/world_site.h"

namespace conav::launcher {
namespace {

/// With fewer robots than `options` have; 0 where there is room for none.
int MostRobots(sim::WorldOptions options) {
  while (--options.robots > 0) {
    if (sim::MakeWorldSpec(options)) break;
  }
  return options.robots;
}

Result<void> CheckWorld(const DemoOptions& options, int index) {
  const sim::WorldOptions world = WorldOptionsOf(options, index);
  if (const auto site = sim::MakeSite(world); !site) {
    const std::string option = options.map.empty() ? "--preset " + options.preset + ": " : "";
    return Fail(site.error().code, option + site.error().text);
  }
  const auto spec = sim::MakeWorldSpec(world);
  if (spec) return {};
  return Fail(
      spec.error().code,
      fmt::format("--robots {}: the world of seed {} has room for {}; with {}, {}", options.robots,
                  world.seed, MostRobots(world), options.robots, spec.error().text));
}

}  // namespace

sim::WorldOptions WorldOptionsOf(const DemoOptions& options, int index) {
  sim::WorldOptions world;
  world.seed = options.world_seed() + static_cast<std::uint64_t>(index);
  world.preset = options.preset;
  world.map_yaml = options.map;
  world.operator_map_yaml = options.operator_map;
  world.cell_size_m = options.cell_size_m.value_or(world.cell_size_m);
  world.robots = options.robots;
  world.shared_goals = options.shared_goals;
  world.rotation_deg = options.rotation_deg;
  return world;
}

Result<void> CheckWorlds(const DemoOptions& options) {
  for (int index = 0; index < options.worlds; ++index) {
    if (auto checked = CheckWorld(options, index); !checked) return checked;
  }
  return {};
}

}  // namespace conav::launcher
