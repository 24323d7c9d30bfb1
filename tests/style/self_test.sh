#!/usr/bin/env bash
# self_test.sh: each check accepts a good file and refuses a bad one, so that a green check means something.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failures=0

# expect accept|refuse CHECK PATH TEXT: runs CHECK on a tree that holds only PATH.
expect() {
  local wanted=$1 check=$2 file=$3 text=$4 got=accept
  rm -rf "${tree:?}"/*
  cp "$here/../../.clang-format" "$tree/"
  mkdir -p "$tree/$(dirname "$file")"
  printf '%b' "$text" >"$tree/$file"
  "$here/$check" "$tree" >"$tree/output.txt" 2>&1 || got=refuse
  [[ $got == "$wanted" ]] && return
  printf '%s should %s %s: %s\n' "$check" "$wanted" "$file" "$text"
  failures=$((failures + 1))
}

# lines N: so many empty ones.
lines() { printf '%*s' "$1" '' | sed 's/ /\\n/g'; }

expect accept check_format.sh services/a.cc 'int main() { return 0; }\n'
expect refuse check_format.sh services/a.cc 'int main(){return 0;}\n'
expect accept check_files.sh services/a_b.h '#pragma once\n'
expect refuse check_files.sh services/aB.cc '\n'
expect refuse check_files.sh services/a.h '#include <vector>\n'
expect refuse check_files.sh services/a.cc "$(lines 501)"
expect refuse check_files.sh tests/a_test.cc '\n'
expect refuse check_files.sh services/a_test.cc 'TEST_CASE("a; b") {}\n'
expect refuse check_files.sh services/a.cc 'auto a = CLI::Range(0.0, 1.0);\n'
expect accept check_structure.sh services/a.cc "$(lines 100)"
expect refuse check_structure.sh services/a.cc "$(lines 99)"
expect refuse check_structure.sh services/a.cc "$(lines 100001)"
expect accept check_structure.sh services/a.cc "$(lines 50)void F() {\n$(lines 60)}\n"
expect refuse check_structure.sh services/a.cc "$(lines 50)void F() {\n$(lines 61)}\n"
expect refuse check_structure.sh tests/a.cc "$(lines 100)"
# shellcheck disable=SC2016
expect accept check_shell.sh a.sh '#!/bin/bash\necho "$1"\n'
# shellcheck disable=SC2016
expect refuse check_shell.sh a.sh '#!/bin/bash\necho $1\n'

accept_message() { expect accept check_messages.py idl/conav_msgs/msg/A.idl "$1"; }
refuse_message() { expect refuse check_messages.py idl/conav_msgs/msg/A.idl "$1"; }
message() { printf 'module conav_msgs { module msg {\n%s\n}; };\n' "$1"; }
accept_message "$(message 'module A_Constants { const uint8 ONE = 1; };\nstruct A { uint8 kind; sequence<double> all; };')"
accept_message "#include \"conav_msgs/msg/B.idl\"\n$(message 'struct A { conav_msgs::msg::B b; float c[2]; };')"
refuse_message "$(message 'struct A { conav_msgs::msg::B b; };')"
refuse_message "$(message 'struct A { B b; };')"
refuse_message "$(message 'struct B { double b; };')"
refuse_message "$(message 'struct A { double A; };')"
refuse_message "$(message 'struct A { octet a; };')"
refuse_message "$(message 'const uint8 ONE = 1; struct A { double a; };')"
refuse_message "$(message 'struct B { double b; }; struct A { double a; };')"
refuse_message "#ifndef A\n$(message 'struct A { double a; };')#endif\n"
refuse_message "$(message 'struct A { @key double a; };')"

accept_include() { expect accept check_includes.sh "$1" "#include $2\n"; }
refuse_include() { expect refuse check_includes.sh "$1" "#include $2\n"; }
accept_include services/study/python/a.cc '<pybind11/stl.h>'
refuse_include services/study/experiment/a.cc '<pybind11/stl.h>'
accept_include services/common/bus/a.cc '<dds/dds.h>'
refuse_include services/sim/sim_service.cc '<dds/dds.h>'
refuse_include tests/unit/sim/a_test.cc '"fastdds/dds/topic/Topic.hpp"'
accept_include services/sim/world/a.cc '<fmt/core.h>'
refuse_include services/sim/world/a.cc '<fmt/format.h>'
accept_include services/common/msg/convert.h '"conav_msgs.h"'
accept_include services/sim/robot_topics.h '"conav_msgs.h"'
refuse_include services/planner/search/a.h '"conav_msgs.h"'
refuse_include services/planner/search/a.h '"common/bus/publisher.h"'
refuse_include services/nhpm/model/a.cc '"common/msg/convert.h"'
accept_include services/nhpm/model/a.cc '"common/msg/planning.h"'
refuse_include services/sim/world/a.h '"common/bus/publisher.h"'
refuse_include services/sim/world/a.cc '"planner/search/ig_mcts.h"'
refuse_include services/sim/sim_service.cc '"operator/config.h"'
accept_include services/planner/planner_service.cc '"nhpm/model/glpf.h"'
refuse_include services/planner/planner_service.cc '"nhpm/nhpm_service.h"'
refuse_include services/common/grid/a.h '"common/msg/robot.h"'
refuse_include services/common/service/a.h '"sim/config.h"'
accept_include deploy/launcher/a.cc '"sim/config.h"'
accept_include deploy/launcher/a.cc '"nhpm/model/weights_file.h"'
refuse_include deploy/launcher/a.cc '"sim/sim_service.h"'
accept_name() { expect accept check_naming.py services/a.h "$1\n"; }
refuse_name() { expect refuse check_naming.py services/a.h "$1\n"; }
accept_name 'constexpr int kLimit = 3;\nint BoundedSum(int first_value) { return first_value + kLimit; }'
accept_name 'enum class Colour { kRed };\nclass List {\n public:\n  int size() const;\n\n private:\n  int size_ = 0;\n};'
refuse_name 'int bounded_sum(int first);'
refuse_name 'int BoundedSum(int FirstValue);'
refuse_name 'inline int Two() {\n  const int Result = 2;\n  return Result;\n}'
refuse_name 'constexpr int limit = 3;'
refuse_name 'enum class Colour { RED };'
refuse_name 'struct point {};'
refuse_name 'class Point {\n private:\n  int row = 0;\n};'
refuse_name 'namespace Points {}'
# clang-tidy goes by a compile database: here one of a single file, in the tree itself.
expect_tidy() {
  local wanted=$1 text=$2 got=accept
  rm -rf "${tree:?}"/*
  cp "$here/../../.clang-tidy" "$tree/"
  mkdir -p "$tree/services"
  printf '%b' "$text" >"$tree/services/a.cc"
  printf '[{"directory": "%s", "command": "g++ -std=c++20 -c services/a.cc",\n"file": "%s/services/a.cc"}]\n' \
    "$tree" "$tree" >"$tree/compile_commands.json"
  "$here/check_tidy.sh" "$tree" "$tree" >"$tree/output.txt" 2>&1 || got=refuse
  [[ $got == "$wanted" ]] && return
  printf 'check_tidy.sh should %s: %s\n' "$wanted" "$text"
  failures=$((failures + 1))
}
expect_tidy accept 'constexpr int kLimit = 3;\nint BoundedSum(int first_value) { return first_value + kLimit; }\n'
expect_tidy refuse 'int bounded_sum(int first) { return first; }\n'
expect_tidy refuse 'int BoundedSum(int FirstValue) { return FirstValue; }\n'
echo "$failures failures"
((failures == 0))
