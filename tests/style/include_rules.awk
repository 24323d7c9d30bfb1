# Reads "file include" pairs and refuses the includes that the layers forbid; see check_includes.sh.
# Layers: main -> service -> topics and clients -> pure library -> common. A file's name says whether it may know the bus.

function refuse(rule) { printf "%s includes \"%s\": %s\n", file, inc, rule; failures++ }
function below(folder) { return index(file, folder) == 1 }
function any_below(list,   i, n, folders) {
  n = split(list, folders, " ")
  for (i = 1; i <= n; i++) if (below(folders[i])) return 1
  return 0
}

BEGIN {
  vendor_places = "services/common/bus/ tests/system/bus/ tests/bench/ tests/unit/common/bus/"
  idl_places = "services/common/bus/ services/common/service/ services/common/msg/convert tests/"
  protobuf_places = "services/common/segments/ services/nhpm/model/ services/nhpm/training/ services/planner/explain/ " \
                    "services/operator/console/ services/operator/gateway/ tests/"
}

{
  file = $1
  inc = $2
  is_vendor = inc ~ /^(dds|ddsc|ddsrt|fastdds|fastrtps|fastcdr)\//
  is_idl = inc ~ /^(conav_msgs|conav_srvs|ros2_interfaces|ros2_services|ros2_graph)(TypeObject|PubSubTypes)?\.h$/
  is_bus = inc ~ /^common\/(bus|service)\// || inc == "common/msg/convert.h" || inc ~ /^sys\/socket|^netinet\//
  split(file, part, "/")
  in_service = part[1] == "services" && part[2] != "common" && part[2] != "study"
  other = inc
  sub(/\/.*/, "", other)
  is_service = other ~ /^(sim|planner|nhpm|operator)$/ && inc ~ /\//

  # What talks on the bus is named so: x_service, x_topics, x_services, x_actions, x_client, main, and config for the participant's options.
  talks = file ~ /\/([a-z0-9_]+_(services?|actions|topics|client|main)|main|config)\.(h|cc)$/ || below("services/planner/perception/")
  # Offline: synthetic annotators look at the simulator's mazes.
  synthesises = below("services/nhpm/") && inc ~ /^(sim\/world|operator\/simulated)\//

  if (is_vendor && !any_below(vendor_places)) refuse("only services/common/bus includes DDS")
  if (inc ~ /^fmt\/(format|ranges|chrono)\.h$/)
    refuse("take fmt/core.h, and Join() and UtcTime() of common/runtime/text.h: this takes seconds of compiling in each program")
  if (is_idl && !(in_service && talks) && !any_below(idl_places)) refuse("IDL types stop at common/msg/convert.h")
  if (inc ~ /\.pb\.h$/ && !any_below(protobuf_places)) refuse("protobuf types stay with the readers and writers of their files")
  if (in_service && !talks && is_bus)
    refuse("only files named *_topics, *_service(s), *_actions, *_client, main or config know the bus")
  if (in_service && is_service && other != part[2] && !synthesises &&
      !(below("services/planner/") && talks && inc ~ /^nhpm\/model\//))
    refuse("a service includes no other service (the planner may embed nhpm/model)")
  if (below("services/common/") && is_service) refuse("common includes no service")
  if ((below("services/common/grid/") || below("services/common/runtime/")) && inc ~ /^common\// &&
      inc !~ /^common\/(grid|runtime)\//) refuse("grid and runtime are the lowest layer")
  if (below("services/common/") && !any_below("services/common/bus/ services/common/service/ services/common/msg/convert") && is_bus)
    refuse("only common/bus, common/service and common/msg/convert know the bus")
  if (inc ~ /^pybind11\// && !below("services/study/python/")) refuse("only services/study/python binds to Python")
  # A study draws people, plays episodes in one process and runs the launcher.
  if (below("services/study/statistics/") && is_service) refuse("statistics know no service")
  soaks = below("deploy/launcher/soak") && inc ~ /^operator\/(belief\/database|simulated\/operator_client)\.h$/
  if (below("deploy/") && is_service && inc !~ /\/config\.h$/ && inc !~ /^(nhpm\/model|sim\/world)\// && !soaks)
    refuse("the launcher sees only config.h of a service, and weights and worlds to see whether they fit (soak: the client and its journal)")
  if (in_service && inc ~ /^(launcher|study)\//) refuse("services know neither the launcher nor the study")
  if (below("deploy/") && inc ~ /^study\//) refuse("the launcher knows no study")
  count++
}

END {
  printf "%d includes, %d refused\n", count, failures
  exit failures > 0 || count == 0
}
