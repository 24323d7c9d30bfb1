#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "common/msg/perception_model.h"
#include "common/runtime/random.h"

/// What every PerceptionModel must do, whatever stands behind it: local, remote, cached, fake.
/// Call CheckPerceptionModelConformance() from a TEST_CASE; it holds SECTIONs.
namespace conav::planner::conformance {

/// A random but repeatable query that every model must answer: walls around, a belief of 0s and 1s,
/// a path that ends in the camera's cell, a view from there.
inline PerceptionQuery MakeQuery(std::uint64_t seed, int rows = 9, int columns = 11) {
  Random random(seed);
  OccupancyGrid truth(rows, columns, Occupancy::kFree);
  PerceptionQuery query;
  query.belief = BeliefGrid(rows, columns, 0.0F);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const bool border = truth.OnBorder(truth.CellAt(i));
    if (border || random.Chance(0.3)) truth.values()[i] = Occupancy::kOccupied;
    if (border || random.Chance(0.3)) query.belief.values()[i] = 1.0F;
  }
  query.cell = {static_cast<int>(random.Uniform(1, rows - 2)),
                static_cast<int>(random.Uniform(2, columns - 2))};
  truth[query.cell] = Occupancy::kFree;
  query.path = {query.cell + Cell{0, -1}, query.cell};
  query.heading_rad = HeadingFromIndex(static_cast<int>(random.Uniform(0, 7)), 8);
  query.visible =
      CastView(truth, {.cell = query.cell, .heading_rad = query.heading_rad, .rays = 64});
  return query;
}

inline std::vector<PerceptionQuery> MakeQueries(int count, std::uint64_t seed = 1) {
  std::vector<PerceptionQuery> queries;
  for (int i = 0; i < count; ++i) {
    queries.push_back(MakeQuery(DeriveSeed(seed, static_cast<std::uint64_t>(i))));
  }
  return queries;
}

/// A change to a good query that makes it impossible to answer.
struct InvalidChange {
  const char* name;
  std::function<void(PerceptionQuery&)> apply;
};

inline std::vector<InvalidChange> InvalidChanges() {
  static constexpr Cell kSouthOfMap{9, 0};
  static constexpr Cell kWestOfMap{0, -1};
  return {
      {"no cells", [](auto& query) { query.belief = BeliefGrid(); }},
      {"belief above one", [](auto& query) { query.belief.values()[24] = 1.5F; }},
      {"belief not a number", [](auto& query) { query.belief.values()[24] = NAN; }},
      {"camera outside", [](auto& query) { query.cell.row = -1; }},
      {"path outside", [](auto& query) { query.path.back().column = 11; }},
      {"free cell outside", [](auto& query) { query.visible.free.push_back(kSouthOfMap); }},
      {"wall outside", [](auto& query) { query.visible.walls.push_back(kWestOfMap); }},
      {"heading not finite", [](auto& query) { query.heading_rad = INFINITY; }},
  };
}

/// Shape of the belief, probabilities, and the masks of paper section 4: nothing added where the
/// belief has a wall, nothing removed where it has none, never on the border.
inline void RequireWellFormed(const PerceptionQuery& query, const PerceptionAnswer& answer) {
  REQUIRE(answer.add.rows() == query.belief.rows());
  REQUIRE(answer.add.columns() == query.belief.columns());
  REQUIRE(answer.remove.rows() == query.belief.rows());
  REQUIRE(answer.remove.columns() == query.belief.columns());
  bool in_range = true;
  bool masked = true;
  for (std::size_t i = 0; i < query.belief.size(); ++i) {
    const float add = answer.add.values()[i];
    const float remove = answer.remove.values()[i];
    in_range = in_range && add >= 0.0F && add <= 1.0F && remove >= 0.0F && remove <= 1.0F;
    const bool border = query.belief.OnBorder(query.belief.CellAt(i));
    if (border || query.belief.values()[i] == 1.0F) masked = masked && add == 0.0F;
    if (border || query.belief.values()[i] == 0.0F) masked = masked && remove == 0.0F;
  }
  REQUIRE(in_range);
  REQUIRE(masked);
}

/// `make` builds a fresh model under test; `reference` answers the same questions by itself, and
/// the two must agree bit for bit.
inline void CheckPerceptionModelConformance(
    const std::function<std::shared_ptr<PerceptionModel>()>& make, PerceptionModel& reference) {
  const std::shared_ptr<PerceptionModel> model = make();
  const std::vector<PerceptionQuery> queries = MakeQueries(12);
  const auto expected = reference.Predict(queries);
  REQUIRE(expected.has_value());

  SECTION("it has a name") { REQUIRE_FALSE(model->identity().name.empty()); }

  SECTION("an empty batch gives an empty answer") {
    const auto answers = model->Predict({});
    REQUIRE(answers.has_value());
    REQUIRE(answers->empty());
  }

  SECTION("one answer per query, in order, with the bits of the reference") {
    const auto answers = model->Predict(queries);
    REQUIRE(answers.has_value());
    REQUIRE(*answers == *expected);
    for (std::size_t i = 0; i < queries.size(); ++i) RequireWellFormed(queries[i], (*answers)[i]);
  }

  SECTION("a batch of one equals the same query inside a larger batch, whatever the order") {
    for (std::size_t i = queries.size(); i-- > 0;) {
      const auto answers = model->Predict(std::span(queries).subspan(i, 1));
      REQUIRE(answers.has_value());
      REQUIRE(answers->size() == 1);
      REQUIRE(answers->front() == (*expected)[i]);
    }
  }

  SECTION("the same query again, and twice in one batch, gives the same answer") {
    const std::vector<PerceptionQuery> twice{queries[3], queries[0], queries[3]};
    for (int repeat = 0; repeat < 2; ++repeat) {
      const auto answers = model->Predict(twice);
      REQUIRE(answers.has_value());
      REQUIRE(*answers == std::vector{(*expected)[3], (*expected)[0], (*expected)[3]});
    }
  }

  SECTION("the edits of views are those expected of the answers, whatever was asked before") {
    std::vector<PerceptionQuery> asked = queries;
    for (const PerceptionQuery& query : queries) {
      // The same view after a longer path, and by a belief that differs in a few cells.
      asked.push_back(query);
      asked.back().path.push_back({1, 1});
      asked.push_back(asked.back());
      for (const Cell cell : {Cell{2, 2}, Cell{4, 5}}) asked.back().belief[cell] = 0.25F;
    }
    for (const PerceptionQuery& query : asked) {
      const auto belief = std::make_shared<const BeliefGrid>(query.belief);
      const ShownView view{query.path, query.cell, query.heading_rad, query.visible};
      const ShownView other{{query.cell}, query.cell, query.heading_rad + 1.0, {}};
      const auto edits = model->PredictEdits(belief, std::vector{view, other, view});
      REQUIRE(edits.has_value());
      const auto answer = reference.Predict({&query, 1});
      REQUIRE(edits->size() == 3);
      REQUIRE(edits->at(0) == ExpectedEdits(answer->front()));
      REQUIRE(edits->at(2) == edits->at(0));
    }
  }

  SECTION("a view that cannot be answered is refused") {
    for (const InvalidChange& change : InvalidChanges()) {
      INFO(change.name);
      PerceptionQuery query = queries[0];
      change.apply(query);
      const auto belief = std::make_shared<const BeliefGrid>(query.belief);
      const ShownView view{query.path, query.cell, query.heading_rad, query.visible};
      const auto edits = model->PredictEdits(belief, {&view, 1});
      REQUIRE_FALSE(edits.has_value());
      REQUIRE(edits.error().code == ErrorCode::kInvalidArgument);
    }
  }

  SECTION("a belief between 0 and 1 and an empty path and view are answered") {
    PerceptionQuery query = queries[0];
    for (float& value : query.belief.values()) value = 0.25F;
    query.path.clear();
    query.visible = {};
    const auto answers = model->Predict({&query, 1});
    REQUIRE(answers.has_value());
    RequireWellFormed(query, answers->at(0));
  }

  SECTION("a query that cannot be answered is refused by name, and later ones are answered") {
    for (const InvalidChange& change : InvalidChanges()) {
      INFO(change.name);
      std::vector<PerceptionQuery> batch{queries[0], queries[1]};
      change.apply(batch[1]);
      const auto answers = model->Predict(batch);
      REQUIRE_FALSE(answers.has_value());
      REQUIRE(answers.error().code == ErrorCode::kInvalidArgument);
      REQUIRE_FALSE(answers.error().text.empty());
    }
    const auto answers = model->Predict(queries);
    REQUIRE(answers.has_value());
    REQUIRE(*answers == *expected);
  }

  SECTION("concurrent callers each get their own answers") {
    constexpr int kThreads = 4;
    std::vector<int> wrong(kThreads, 0);  // one slot per thread
    std::vector<std::thread> threads;
    for (int thread = 0; thread < kThreads; ++thread) {
      threads.emplace_back([&, thread] {
        const auto slot = static_cast<std::size_t>(thread);
        for (std::size_t i = 0; i < 16; ++i) {
          const std::size_t first = (slot + i) % (queries.size() - 3);
          const auto answers = model->Predict(std::span(queries).subspan(first, 3));
          const bool equal = answers && answers->size() == 3 &&
                             std::equal(answers->begin(), answers->end(),
                                        expected->begin() + static_cast<std::ptrdiff_t>(first));
          wrong[slot] += equal ? 0 : 1;
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    REQUIRE(wrong == std::vector<int>(kThreads, 0));
  }
}

}  // namespace conav::planner::conformance
