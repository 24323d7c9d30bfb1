# Runs the benchmark shortly and looks for each documented metric. Says nothing about speed.
execute_process(COMMAND ${PROGRAM} --rounds 1 --episodes 1 --json ${JSON} COMMAND_ERROR_IS_FATAL ANY)
file(READ ${JSON} text)
string(JSON overrun GET "${text}" metrics time_budget_overrun_ms_max)
foreach(metric iterations100_p50_ms iterations100_p95_ms default_p50_ms default_p95_ms rollout_steps_per_s plain_ratio
               robots_per_core_5hz trees4_threads1_p50_ms trees4_threads2_p50_ms trees4_threads4_p50_ms)
  string(JSON value GET "${text}" metrics ${metric})
  if(NOT value GREATER 0)
    message(FATAL_ERROR "${metric} is ${value}")
  endif()
endforeach()
