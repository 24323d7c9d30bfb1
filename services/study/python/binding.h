#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
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

/// `value` as a T. Throws PythonError with `name`, the value and what is expected.
template <class T>
T Argument(const std::string& name, const py::handle& value) {
  std::string expected = "a list of cells (row, column)";
  bool good = true;
  if constexpr (std::is_same_v<T, bool>) {
    expected = "True or False";
    good = PyBool_Check(value.ptr()) != 0;
  } else if constexpr (std::is_integral_v<T>) {
    using Limits = std::numeric_limits<T>;
    expected = fmt::format("an integer in [{}, {}]", Limits::min(), Limits::max());
    good = PyIndex_Check(value.ptr()) != 0;  // 1.5 is not one
  } else if constexpr (std::is_floating_point_v<T>) {
    expected = "a finite number";
  } else if constexpr (std::is_same_v<T, std::string>) {
    expected = "a text";
  }
  py::detail::make_caster<T> caster;
  good = good && caster.load(value, true);
  if constexpr (std::is_floating_point_v<T>) {
    good = good && std::isfinite(py::detail::cast_op<T>(caster));
  }
  Check(good,
        fmt::format("{} = {}; expected {}", name, py::repr(value).cast<std::string>(), expected));
  return py::detail::cast_op<T>(std::move(caster));
}

/// `value` with the keys of `settings`, a dict like a section of a configuration file.
template <class T>
T Configured(const py::dict& settings, const std::string& name, T value) {
  YAML::Node node(YAML::NodeType::Map);
  for (const auto& [key, setting] : settings) {
    const auto text = py::str(key).cast<std::string>();
    try {
      const py::object json = py::module_::import("json").attr("dumps")(setting);
      node[text] = YAML::Load(json.cast<std::string>());  // JSON is YAML
    } catch (const py::error_already_set& error) {
      throw PythonError(
          fmt::format("{}.{}: {}", name, text, py::str(error.value()).cast<std::string>()));
    }
  }
  ReadConfig(node, name, value);
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

/// As pybind's, with another name in messages.
template <>
struct type_caster<std::uint64_t> {
  PYBIND11_TYPE_CASTER(std::uint64_t, const_name("int >= 0"));

  bool load(handle source, bool convert) {
    make_caster<unsigned long long> number;
    if (!PyIndex_Check(source.ptr()) || !number.load(source, convert)) return false;
    value = cast_op<unsigned long long>(number);
    return true;
  }

  static handle cast(std::uint64_t number, return_value_policy, handle) {
    return PyLong_FromUnsignedLong(number);
  }
};

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
  // A map is loaded as numbers of any kind, as in uint8 257 and nan look like cells.
  using Loaded = std::conditional_t<std::is_enum_v<T>, double, T>;
  using Array = array_t<Loaded, array::c_style | array::forcecast>;
  PYBIND11_TYPE_CASTER(conav::Grid<T>, const_name("numpy.ndarray"));

  bool load(handle source, bool convert) {
    if (!convert && !Array::check_(source)) return false;
    const auto array = Array::ensure(source);
    if (!array || array.ndim() != 2) return false;
    value = conav::Grid<T>(static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)));
    for (std::size_t i = 0; i < value.size(); ++i) {
      const Loaded element = array.data()[i];
      if constexpr (std::is_enum_v<T>) {
        if (element != 0.0 && element != 1.0 && element != 2.0) return false;
        value.values()[i] = static_cast<T>(static_cast<Element>(element));
      } else {
        value.values()[i] = element;
      }
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
