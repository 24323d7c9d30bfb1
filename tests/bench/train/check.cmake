# Runs the benchmark shortly and looks for each documented metric. Says nothing about speed.
execute_process(COMMAND ${PROGRAM} --rounds 1 --examples 64 --width 16 --json ${JSON} COMMAND_ERROR_IS_FATAL ANY)
file(READ ${JSON} text)
foreach(metric epoch_s fma_limit_ratio)
  string(JSON value GET "${text}" metrics ${metric})
  if(NOT value GREATER 0)
    message(FATAL_ERROR "${metric} is ${value}")
  endif()
endforeach()
