# Runs the benchmark with few robots at four times the speed, for which docs/reliability.md promises nothing: 12 kB/s each when this
# was written, 81 in real time before anything was done about links.
include(${CMAKE_CURRENT_LIST_DIR}/../support/run_on_hosts.cmake)
run_on_hosts(--robots 4 --speed 4)
if(skipped)
  return()
endif()
string(JSON per_robot GET "${text}" metrics operator_link_bytes_per_s_per_robot)
string(JSON episode GET "${text}" metrics episode_bytes)
if(per_robot GREATER 20000 OR NOT episode GREATER 100000)
  message(FATAL_ERROR "${per_robot} bytes/s per robot on the operator's link, ${episode} bytes an episode")
endif()
