# run_on_hosts(OPTION...): runs PROGRAM, which needs hosts of network namespaces, with its options and --json JSON; sets `text` to what
# it wrote, or `skipped`.
function(run_on_hosts)
  execute_process(COMMAND ${PROGRAM} ${ARGN} --json ${JSON}
    RESULT_VARIABLE code ERROR_VARIABLE errors ECHO_ERROR_VARIABLE)
  if(code EQUAL 0)
    file(READ ${JSON} written)
    set(text "${written}" PARENT_SCOPE)
  elseif(errors MATCHES "needs network namespaces")
    message("skipped: no network namespaces here")
    set(skipped ON PARENT_SCOPE)
  else()
    message(FATAL_ERROR "exit code ${code}")
  endif()
endfunction()
