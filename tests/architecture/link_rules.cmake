# cmake -DBINARY=... -DFORBIDDEN=regex -DEXPECTED=regex -P link_rules.cmake
# The libraries that a binary loads, also indirectly. EXPECTED shows that the list was read.
execute_process(COMMAND ldd "${BINARY}" OUTPUT_VARIABLE libraries RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "ldd could not read ${BINARY}")
endif()
if(NOT libraries MATCHES "${EXPECTED}")
  message(FATAL_ERROR "${BINARY} does not load ${EXPECTED}:\n${libraries}")
endif()
if(FORBIDDEN AND libraries MATCHES "[^\n]*lib(${FORBIDDEN})[^\n]*")
  message(FATAL_ERROR "${BINARY} loads what it must not: ${CMAKE_MATCH_0}")
endif()
