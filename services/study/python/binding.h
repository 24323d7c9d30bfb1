#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>

#include "common/grid/grid.h"
#include "common/runtime/config.h"
#include "common/runtime/result.h"

/// What the parts of the Python module `conav._conav` share. In Python a cell is a tuple (row, column),
/// a map an array uint8 of Occupancy (0 unknown, 1 free, 2 wall), a belief an array float32, an error a
/// conav.Error with the text of the C++ error. Arguments are checked here: a broken contract would abort
/// the interpreter. Arrays are copies.
namespace conav::python {

namespace py = pybind11;

/// Sets the exception conav.Error.
class PythonError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <class T>
T Take(Result<T> result) {
  if (!result) throw PythonError(result.error().text);
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

/// Throws PythonError with this text unless `good`.
inline void Check(bool good, const std::string& text) {
  if (!good) throw PythonError(text);
}

/// `value` with the keys of `settings`, a dict like a section of a configuration file.
template <class T>
T Configured(const py::dict& settings, const std::string& name, T value) {
  const auto text = py::module_::import("json").attr("dumps")(settings).cast<std::string>();
  ReadConfig(YAML::Load(text), name, value);  // JSON is YAML
  return value;
}

template <class T>
T Configured(const py::dict& settings, const std::string& name) {
  T defaults;
  return Configured(settings, name, std::move(defaults));
}

void AddWorlds(py::module_& module);
void AddModels(py::module_& module);
void AddDecisions(py::module_& module);
void AddOperators(py::module_& module);
void AddEpisodes(py::module_& module);

}  // namespace conav::python

namespace pybind11::detail {

template <>
struct type_caster<conav::Cell> {
  PYBIND11_TYPE_CASTER(conav::Cell, const_name("Tuple[int, int]"));

  bool load(handle source, bool /*convert*/) {
    if (!isinstance<sequence>(source) || len(source) != 2) return false;
    const auto cell = reinterpret_borrow<sequence>(source);
    make_caster<int> row;
    make_caster<int> column;
    if (!row.load(cell[0], true) || !column.load(cell[1], true)) return false;
    value = {cast_op<int>(row), cast_op<int>(column)};
    return true;
  }

  static handle cast(conav::Cell cell, return_value_policy, handle) {
    return make_tuple(cell.row, cell.column).release();
  }
};

template <class T>
struct type_caster<conav::Grid<T>> {
  using Element = std::conditional_t<std::is_enum_v<T>, std::uint8_t, T>;
  using Array = array_t<Element, array::c_style | array::forcecast>;
  PYBIND11_TYPE_CASTER(conav::Grid<T>, const_name("numpy.ndarray"));

  bool load(handle source, bool convert) {
    if (!convert && !Array::check_(source)) return false;
    const auto array = Array::ensure(source);
    if (!array || array.ndim() != 2) return false;
    value = conav::Grid<T>(static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)));
    for (std::size_t i = 0; i < value.size(); ++i) {
      const Element element = array.data()[i];
      if constexpr (std::is_enum_v<T>) {
        if (element > static_cast<Element>(conav::Occupancy::kOccupied)) return false;
      }
      value.values()[i] = static_cast<T>(element);
    }
    return true;
  }

  static handle cast(const conav::Grid<T>& grid, return_value_policy, handle) {
    array_t<Element> array({grid.rows(), grid.columns()});
    std::memcpy(array.mutable_data(), grid.values().data(), grid.size() * sizeof(Element));
    return array.release();
  }
};

}  // namespace pybind11::detail
