#pragma once

#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "common/runtime/file.h"
#include "study/statistics/table_reader.h"

/// Data sets that ship with R, and figures of R 4.2.2 for them: `data/oracle_<name>.csv` is the
/// data, `data/oracle_<name>_pairs.csv` the figures of its pairs.
namespace conav::statistics {

inline std::string ReferencePath(const std::string& name) {
  return std::string(CONAV_TESTS_DIR) + "/unit/study/statistics/data/oracle_" + name + ".csv";
}

/// nlme::ergoStool: "ergoStool"; carData::OBrienKaiser, five hours before: "OBK_pre";
/// afex::obk.long by phase: "obk_phase".
inline ConditionTable ReferenceTable(const std::string& name) {
  const auto bytes = ReadFile(ReferencePath(name));
  REQUIRE(bytes);
  auto file = ParseTable(*bytes, name);
  REQUIRE(file);
  return std::move(file->table);
}

/// datasets::sleep: hours of sleep that two drugs gave ten patients.
inline ConditionTable SleepTable() {
  return {.conditions = {"1", "2"},
          .subjects = {"1", "2", "3", "4", "5", "6", "7", "8", "9", "10"},
          .values = {0.7, 1.9, -1.6, 0.8, -0.2, 1.1, -1.2, 0.1, -0.1, -0.1,
                     3.4, 4.4, 3.7,  5.5, 0.8,  1.6, 0.0,  4.6, 2.0,  3.4}};
}

/// Subjects without names of their own.
inline ConditionTable MakeTable(std::vector<std::string> conditions, std::vector<double> values) {
  ConditionTable table{std::move(conditions), {}, std::move(values)};
  for (std::size_t i = 0; i < table.values.size() / table.conditions.size(); ++i) {
    table.subjects.push_back(std::to_string(i + 1));
  }
  return table;
}

/// Equal to within 1e-9 of the value.
inline Approx Near(double value) { return Approx(value).epsilon(1e-9).margin(1e-300); }

}  // namespace conav::statistics
