#include "study/design.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/runtime/random.h"
#include "common/runtime/result.h"

namespace conav::study {
namespace {

/// Purposes for DeriveSeed.
constexpr std::uint64_t kOrderSeed = 1;
constexpr std::uint64_t kLayoutSeed = 2;
constexpr std::uint64_t kEpisodeSeed = 3;

std::uint64_t Below31Bits(std::uint64_t seed) { return seed >> 33; }

std::vector<std::uint64_t> ChooseLayouts(const DesignOptions& options) {
  std::vector<std::uint64_t> layouts(std::begin(kPaperLayouts), std::end(kPaperLayouts));
  Random random(DeriveSeed(options.seed, kLayoutSeed));
  const auto count = static_cast<std::size_t>(options.layouts);
  while (layouts.size() < count) {
    const std::uint64_t seed = Below31Bits(random.Next());
    if (std::find(layouts.begin(), layouts.end(), seed) == layouts.end()) layouts.push_back(seed);
  }
  layouts.resize(count);
  return layouts;
}

/// The row of the Williams design for each subject.
std::vector<std::size_t> ChooseRows(int operators, std::size_t rows, Random& random) {
  std::vector<std::size_t> chosen;
  while (chosen.size() < static_cast<std::size_t>(operators)) {
    std::vector<std::size_t> block(rows);
    for (std::size_t row = 0; row < rows; ++row) block[row] = row;
    random.Shuffle(block);
    chosen.insert(chosen.end(), block.begin(), block.end());
  }
  chosen.resize(static_cast<std::size_t>(operators));
  return chosen;
}

std::vector<int> Tasks(int layouts, Random& random) {
  std::vector<int> tasks;
  for (int layout = 0; layout < layouts; ++layout) tasks.push_back(layout);
  random.Shuffle(tasks);
  return tasks;
}

std::string NameOf(const PlannedEpisode& episode, const std::string& subject) {
  return fmt::format("{}-{}-{}-{}-{}r{}", subject, episode.session + 1, episode.task + 1,
                     episode.method, episode.maze_seed, episode.rotation_deg);
}

}  // namespace

std::vector<std::vector<int>> WilliamsDesign(int conditions) {
  DEMAND(conditions >= 1, conditions);
  // First row 0, 1, k-1, 2, k-2, ...: all its steps from one condition to the next are different.
  std::vector<int> first;
  for (int place = 0; place < conditions; ++place) {
    first.push_back(place % 2 == 1 ? (place + 1) / 2 : (conditions - place / 2) % conditions);
  }
  std::vector<std::vector<int>> orders;
  for (int shift = 0; shift < conditions; ++shift) {
    std::vector<int> order;
    for (const int condition : first) order.push_back((condition + shift) % conditions);
    orders.push_back(std::move(order));
  }
  if (conditions % 2 == 0 || conditions == 1) return orders;
  // For an odd number, mirror images balance the followers.
  const std::size_t count = orders.size();
  for (std::size_t row = 0; row < count; ++row) {
    orders.emplace_back(orders[row].rbegin(), orders[row].rend());
  }
  return orders;
}

Design MakeDesign(const DesignOptions& options) {
  const auto methods = static_cast<int>(options.methods.size());
  DEMAND(options.operators >= 1 && options.layouts >= 1, options.operators, options.layouts);
  DEMAND(methods >= 1 && methods <= kOrientations, methods);
  Design design{.methods = options.methods, .layouts = ChooseLayouts(options)};
  const auto williams = WilliamsDesign(methods);
  const auto rows = static_cast<int>(williams.size());
  Random random(DeriveSeed(options.seed, kOrderSeed));
  const auto row_of = ChooseRows(options.operators, williams.size(), random);
  const auto width = std::max<std::size_t>(2, std::to_string(options.operators).size());
  for (int subject = 0; subject < options.operators; ++subject) {
    design.subjects.push_back(fmt::format("s{:0{}}", subject + 1, width));
    design.orders.emplace_back();
    for (int session = 0; session < methods; ++session) {
      const int method =
          williams[row_of[static_cast<std::size_t>(subject)]][static_cast<std::size_t>(session)];
      design.orders.back().push_back(options.methods[static_cast<std::size_t>(method)]);
      const auto tasks = Tasks(options.layouts, random);
      for (int task = 0; task < options.layouts; ++task) {
        const int layout = tasks[static_cast<std::size_t>(task)];
        PlannedEpisode episode{.subject = subject, .session = session, .task = task};
        episode.method = design.orders.back().back();
        episode.maze_seed = design.layouts[static_cast<std::size_t>(layout)];
        episode.rotation_deg = 90 * ((session + layout + subject / rows) % methods);
        const auto number = static_cast<std::uint64_t>(design.episodes.size());
        episode.seed = Below31Bits(DeriveSeed(DeriveSeed(options.seed, kEpisodeSeed), number));
        episode.name = NameOf(episode, design.subjects.back());
        design.episodes.push_back(std::move(episode));
      }
    }
  }
  return design;
}

}  // namespace conav::study
