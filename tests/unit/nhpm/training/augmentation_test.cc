#include <catch2/catch.hpp>
#include <set>

#include "nhpm/training/batch_pass.h"
#include "unit/nhpm/training/made_up_examples.h"

namespace conav::nhpm {
namespace {

ExampleSet OneExample(int rows, int columns) { return MadeUpExamples(rows, columns, 1, 5); }

/// Behind a transposition, mirroring rows is mirroring columns before it.
int InverseOf(int element) {
  if ((element & 4) == 0) return element;
  return 4 | ((element & 1) << 1) | ((element & 2) >> 1);
}

TEST_CASE("A symmetry and its inverse give the example back", "[nhpm][training]") {
  const auto [rows, columns] = GENERATE(table<int, int>({{5, 5}, {4, 7}, {1, 3}, {1, 1}}));
  const Example example = OneExample(rows, columns).examples[0];
  const GridSymmetries symmetries(rows, columns);
  for (int element = 0; element < symmetries.count(); ++element) {
    INFO(rows << " x " << columns << " element " << element);
    Example turned;
    Example back;
    symmetries.Apply(element, example, turned);
    symmetries.Apply(InverseOf(element), turned, back);
    CHECK((back == example));
  }
}

TEST_CASE("A square has eight different symmetries, another rectangle four", "[nhpm][training]") {
  const auto [rows, columns, count] =
      GENERATE(table<int, int, std::size_t>({{5, 5, 8}, {4, 7, 4}}));
  const Example example = OneExample(rows, columns).examples[0];
  const GridSymmetries symmetries(rows, columns);
  std::set<std::vector<float>> turned;
  for (int element = 0; element < symmetries.count(); ++element) {
    Example result;
    symmetries.Apply(element, example, result);
    turned.insert(result.input);
  }
  CHECK(turned.size() == count);
}

TEST_CASE("The identity changes nothing", "[nhpm][training]") {
  const Example example = OneExample(3, 4).examples[0];
  Example same;
  GridSymmetries(3, 4).Apply(0, example, same);
  CHECK((same == example));
}

TEST_CASE("Transposing moves the channels and labels of a cell together", "[nhpm][training]") {
  const Example example = OneExample(3, 3).examples[0];
  Example turned;
  GridSymmetries(3, 3).Apply(4, example, turned);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      const std::size_t to = row * 3 + column;
      const std::size_t from = column * 3 + row;
      for (std::size_t c = 0; c < kInputChannels; ++c) {
        CHECK(turned.input[to * kInputChannels + c] == example.input[from * kInputChannels + c]);
      }
      for (std::size_t c = 0; c < kOutputChannels; ++c) {
        CHECK(turned.labels[to * kOutputChannels + c] ==
              example.labels[from * kOutputChannels + c]);
      }
    }
  }
}

TEST_CASE("Mirroring the rows swaps north and south", "[nhpm][training]") {
  Example example{std::vector<float>(8, 0.0F), std::vector<OutputLabel>(4, OutputLabel::kKept)};
  example.input[0] = 1.0F;
  example.labels[1] = OutputLabel::kEdited;
  Example turned;
  GridSymmetries(2, 1).Apply(1, example, turned);
  CHECK(turned.input[4] == 1.0F);
  CHECK(turned.labels[3] == OutputLabel::kEdited);
}

}  // namespace
}  // namespace conav::nhpm
