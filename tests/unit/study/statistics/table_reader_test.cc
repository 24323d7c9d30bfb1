#include "study/statistics/table_reader.h"

#include <fmt/core.h>

#include <catch2/catch.hpp>

namespace conav::statistics {
namespace {

using Fields = std::vector<std::string>;

TEST_CASE("A row is cut at its commas but those between quotes, without the spaces around fields",
          "[statistics]") {
  CHECK(*SplitCsvRow("") == Fields{""});
  CHECK(*SplitCsvRow(" a ,\tb b,c") == Fields{"a", "b b", "c"});
  CHECK(*SplitCsvRow("a,,") == Fields{"a", "", ""});
  CHECK(*SplitCsvRow("\"a,b\", \"c \"\"d\"\"\" ,e") == Fields{"a,b", "c \"d\"", "e"});
  CHECK(*SplitCsvRow("\"\",\" 1.5\"") == Fields{"", "1.5"});
  CHECK_FALSE(SplitCsvRow("a,\"b"));     // the quote does not end
  CHECK_FALSE(SplitCsvRow("\"a\"b,c"));  // it ends, but not at a comma
}

TEST_CASE("A table has a row per subject and a column per condition", "[statistics]") {
  const auto file = ParseTable("subject,T1,T2\np1,1,2.5\np2,-3,4e2\n", "t.csv");
  REQUIRE(file);
  CHECK(file->table.conditions == Fields{"T1", "T2"});
  CHECK(file->table.subjects == Fields{"p1", "p2"});
  CHECK(file->table.values == std::vector<double>{1, 2.5, -3, 400});
  CHECK(file->table.At(1, 0) == -3);
  CHECK(ConditionValues(file->table, 1) == std::vector<double>{2.5, 400});
  CHECK(file->left_out.empty());
}

TEST_CASE("Line ends of Windows, a byte order mark, quotes, empty lines and signs are understood",
          "[statistics]") {
  const auto file = ParseTable(
      "\xEF\xBB\xBF\"subject\",\"a, b\",\"c\"\r\n\r\n\"1\",\"+1\", 2 \r\n,,\r\n2,3,4", "t.csv");
  REQUIRE(file);
  CHECK(file->table.conditions[0] == "a, b");
  CHECK(file->table.values == std::vector<double>{1, 2, 3, 4});
}

TEST_CASE("A subject with an empty cell is left out and named", "[statistics]") {
  const auto file = ParseTable("subject,a,b,c\np1,1,2,3\np2,1,,NA\np3,4,5,6\np4,,1,1\n", "t.csv");
  REQUIRE(file);
  CHECK(file->table.subjects == Fields{"p1", "p3"});
  REQUIRE(file->left_out.size() == 2);
  CHECK(file->left_out[0].subject == "p2");
  CHECK(file->left_out[0].line == 3);
  CHECK(file->left_out[0].missing == Fields{"b", "c"});
  CHECK(file->left_out[1].subject == "p4");
}

TEST_CASE("A file that is no table is refused with line, column and value", "[statistics]") {
  struct Row {
    std::string text, place, named;
  };
  const std::string start = "subject,a,b\np1,1,2\n";
  std::vector<Row> rows{
      {"", "t.csv: ", "subject,"},
      {"id,a,b\n", "t.csv:1: ", "'id'"},
      {"subject;a;b\n", "t.csv:1: ", "commas"},
      {"subject,a\n", "t.csv:1: ", "1 condition"},
      {"subject,a,\n", "t.csv:1: ", "column 3"},
      {"\nsubject,a,b,a\n", "t.csv:2: ", "'a' appears twice, in columns 2 and 4"},
      {start + "p2,1\n", "t.csv:3: ", "'b' is missing"},
      {start + "p2\n", "t.csv:3: ", "'a' is missing"},
      {start + "p2,1,5,2\n", "t.csv:3: ", "4 columns instead of 3"},
      {start + ",1,2\n", "t.csv:3: ", "'subject'"},
      {start + "p1,1,2\n", "t.csv:3: ", "'p1' appears twice, first in line 2"},
      {start + "p2,1,\"2\n", "t.csv:3: ", "quote"},
      {start + "p2,1,\"1,5\"", "t.csv:3: ", "'1,5'"},
      {"subject,a,b\np1,,1\np1,1,2\n", "t.csv:3: ", "'p1' appears twice"},  // the first is left out
      {"subject,a,b\n", "t.csv: ", "no subject"},
      {"subject,a,b\np1,1,2\np2,,\n", "t.csv: ", "p2 (line 3) has none in a, b"},
      {"subject,caf\xE9,b\n", "t.csv:1: ", "UTF-8"},
      {"subject,a,b\np\x1B[1m,1,2\n", "t.csv:2: ", "0x1b at position 2"}};
  std::string many = "subject";
  for (int i = 0; i < 65; ++i) many += fmt::format(",c{}", i);
  rows.push_back({many, "t.csv:1: ", "65 conditions"});
  for (const char* wrong : {"x", "1.2.3", "1 2", "nan", "0x10", "--1", "+-1", "+"}) {
    rows.push_back({start + "p2,1," + wrong, "t.csv:3: ", fmt::format("'b': '{}'", wrong)});
  }
  for (const char* wrong : {"1e999", "inf", "-2e100", "1e-101", "1e-999"}) {
    rows.push_back({start + "p2,1," + wrong, "t.csv:3: ", std::string(wrong) + " is out of range"});
  }
  for (const Row& row : rows) {
    INFO(row.text);
    const auto file = ParseTable(row.text, "t.csv");
    REQUIRE_FALSE(file);
    CHECK(file.error().code == ErrorCode::kMalformed);
    CHECK_THAT(file.error().text, Catch::StartsWith(row.place) && Catch::Contains(row.named));
  }
}

}  // namespace
}  // namespace conav::statistics
