# Runs the benchmark shortly, twice, and looks for each documented metric. Says nothing about speed.
function(check_metrics)
  file(READ ${JSON} text)
  foreach(metric ${ARGN})
    string(JSON value GET "${text}" metrics ${metric})
    if(NOT value GREATER 0)
      message(FATAL_ERROR "${metric} is ${value}")
    endif()
  endforeach()
  set(text "${text}" PARENT_SCOPE)
endfunction()

execute_process(COMMAND ${PROGRAM} --rounds 1 --episodes 1 --json ${JSON} COMMAND_ERROR_IS_FATAL ANY)
check_metrics(iterations100_p50_ms iterations100_p95_ms default_p50_ms default_p95_ms rollout_steps_per_s plain_ratio
              robots_per_core_5hz trees4_threads1_p50_ms trees4_threads2_p50_ms trees4_threads4_p50_ms
              region_build_ms region_update_p50_ms region_update_p95_ms
              region1000_build_ms region1000_update_p50_ms region1000_update_p95_ms)
string(JSON overrun GET "${text}" metrics time_budget_overrun_ms_max)

execute_process(COMMAND ${PROGRAM} --rounds 1 --sides 13,26,200 --decisions 3 --json ${JSON} COMMAND_ERROR_IS_FATAL ANY)
check_metrics(p95_ratio)
foreach(side 13 26 200)
  check_metrics(side${side}_p50_ms side${side}_p95_ms side${side}_longest_ms side${side}_step_ms side${side}_memory_mib)
  string(JSON passes GET "${text}" metrics side${side}_whole_passes)
  if(NOT passes EQUAL 1)
    message(FATAL_ERROR "${passes} whole passes of the network in an episode, one is enough")
  endif()
endforeach()
