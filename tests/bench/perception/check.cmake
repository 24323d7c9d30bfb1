# Runs the benchmark shortly and looks for each documented metric. Says nothing about speed.
execute_process(COMMAND ${PROGRAM} --rounds 1 --calls 20 --json ${JSON} COMMAND_ERROR_IS_FATAL ANY)
file(READ ${JSON} text)
foreach(batch single batch32)
  foreach(metric embedded_${batch}_us cyclonedds_${batch}_us fastdds_${batch}_us
                 cyclonedds_${batch}_ratio fastdds_${batch}_ratio)
    string(JSON value GET "${text}" metrics ${metric})
    if(NOT value GREATER 0)
      message(FATAL_ERROR "${metric} is ${value}")
    endif()
  endforeach()
endforeach()
