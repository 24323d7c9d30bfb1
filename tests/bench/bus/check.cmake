# Runs the benchmark shortly and looks for each documented metric. Says nothing about speed.
execute_process(COMMAND ${PROGRAM} --rounds 1 --trips 50 --no-ddsperf --json ${JSON} COMMAND_ERROR_IS_FATAL ANY)
file(READ ${JSON} text)
foreach(metric cyclonedds_64B_ratio cyclonedds_20kB_ratio fastdds_64B_ratio fastdds_20kB_ratio)
  string(JSON value GET "${text}" metrics ${metric})
  if(NOT value GREATER 0)
    message(FATAL_ERROR "${metric} is ${value}")
  endif()
endforeach()
