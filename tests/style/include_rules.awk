# Reads "file include" pairs and refuses the includes that the layers forbid; see check_includes.sh.
# Layers: main -> service -> convert + bus + pure library -> common.

function refuse(rule) { printf "%s includes \"%s\": %s\n", file, inc, rule; failures++ }
function below(folder) { return index(file, folder) == 1 }
function any_below(list,   i, n, folders) {
  n = split(list, folders, " ")
  for (i = 1; i <= n; i++) if (below(folders[i])) return 1
  return 0
}

BEGIN {
  pure = "services/common/grid/ services/common/mapping/ services/common/runtime/ services/common/segments/ services/common/svg/ services/nhpm/dataset/ services/nhpm/engine/ services/nhpm/evaluation/ services/nhpm/synthesis/ services/nhpm/training/ services/sim/world/ services/sim/physics/ services/sim/episode/ " \
         "services/planner/search/ services/planner/decision/ services/planner/lease/ services/planner/record/ services/planner/explain/ services/nhpm/model/ services/operator/alerts/ services/operator/attention/ services/operator/bag/ services/operator/belief/ services/operator/console/ services/operator/control/ services/operator/driving/ services/operator/segments/ services/operator/timeline/ services/operator/simulated/ services/operator/statistics/ services/operator/task/"
  vendor_places = "services/common/bus/ tests/system/bus/ tests/bench/ tests/unit/common/bus/"
  idl_places = "services/common/bus/ services/common/protocol/convert services/common/service/ tests/"
}

{
  file = $1
  inc = $2
  is_vendor = inc ~ /^(dds|ddsc|ddsrt|fastdds|fastrtps|fastcdr)\//
  is_idl = inc ~ /^(conav_robot|conav_operator|conav_planning|ros2_interfaces|ros2_graph)(TypeObject|PubSubTypes)?\.h$/
  # services/<x>/<file> wires; services/<x>/<folder>/... is a library or a part of its own.
  split(file, part, "/")
  in_service = part[1] == "services" && part[2] != "common"
  wires = in_service && (part[4] == "" || part[3] == "simulated_operator" || part[3] == "recorder" || part[3] == "client" || part[3] == "desks" || part[3] == "gateway" || part[3] == "perception")
  other = inc
  sub(/\/.*/, "", other)
  # Offline: synthetic annotators look at the simulator's mazes, experiments play in them.
  synthesises = (below("services/nhpm/synthesis/") && inc ~ /^(sim\/world|operator\/simulated)\//) ||
                (below("services/planner/experiment/") && inc ~ /^(sim\/world|operator\/simulated|nhpm\/model)\//)
  is_service = other ~ /^(sim|planner|nhpm|operator)$/ && inc ~ /\//

  if (is_vendor && !any_below(vendor_places)) refuse("only services/common/bus includes DDS")
  if (is_idl && !wires && !any_below(idl_places)) refuse("IDL types stop at common/protocol/convert.h")
  if (inc ~ /\.pb\.h$/ && !any_below("services/common/segments/ services/nhpm/model/ services/nhpm/training/ services/planner/record/ services/operator/console/ services/operator/gateway/ tests/"))
    refuse("protobuf types stay with the readers and writers of their files")
  if (any_below(pure)) {
    if (inc ~ /^common\/(bus|service)\// || inc == "common/protocol/convert.h" || inc ~ /^sys\/socket|^netinet\//)
      refuse("a pure library knows neither the bus nor IDL types")
    if (is_service && other != part[2] && !synthesises) refuse("a pure library includes no other service")
  }
  if (below("services/common/") && is_service) refuse("common includes no service")
  if ((below("services/common/grid/") || below("services/common/runtime/")) && inc ~ /^common\// &&
      inc !~ /^common\/(grid|runtime)\//) refuse("grid and runtime are the lowest layer")
  if (below("services/common/protocol/") && !below("services/common/protocol/convert") && inc ~ /^common\/(bus|service)\//)
    refuse("protocol values know nothing of the bus")
  if (in_service && is_service && other != part[2] && !synthesises &&
      !(part[2] == "planner" && wires && inc ~ /^nhpm\/model\//))
    refuse("a service includes no other service (the planner may embed nhpm/model)")
  # A study draws people and computes statistics, both pure.
  studies = below("deploy/study/") && inc ~ /^(operator\/(attention|simulated|statistics)|nhpm\/synthesis)\//
  if (below("deploy/") && is_service && inc !~ /\/config\.h$/ && inc !~ /^(nhpm\/model|sim\/world)\// && !studies)
    refuse("the launcher sees only config.h of a service, and weights and worlds to see whether they fit")
  if (below("services/") && inc ~ /^launcher\//) refuse("services know nothing of the launcher")
  count++
}

END {
  printf "%d includes, %d refused\n", count, failures
  exit failures > 0 || count == 0
}
