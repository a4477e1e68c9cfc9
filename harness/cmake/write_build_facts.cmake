# cmake -DOUTPUT=<header> -DSOURCE=<checkout> -DVERSION= -DGIT=<program> -DFLAGS= -DTYPE= -DLIBRARIES=<name=version|...>
#       -P write_build_facts.cmake
# Writes the header if a fact has changed. Outside a checkout of volmark itself the commit is "unknown".
set(commit "unknown")
set(dirty "unknown")
if(GIT)
  execute_process(COMMAND ${GIT} -C ${SOURCE} rev-parse --show-toplevel HEAD OUTPUT_VARIABLE answer ERROR_QUIET
                  RESULT_VARIABLE result OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(result EQUAL 0 AND answer MATCHES "^(.*)\n([0-9a-f]+)$")
    set(head ${CMAKE_MATCH_2})
    file(REAL_PATH "${CMAKE_MATCH_1}" toplevel)
    file(REAL_PATH "${SOURCE}" source)
    if(toplevel STREQUAL source)
      set(commit ${head})
      execute_process(COMMAND ${GIT} --no-optional-locks -C ${SOURCE} status --porcelain --untracked-files=no
                      OUTPUT_VARIABLE changes ERROR_QUIET RESULT_VARIABLE result)
      if(result EQUAL 0)
        string(COMPARE NOTEQUAL "${changes}" "" isDirty)
        set(dirty "no")
        if(isDirty)
          set(dirty "yes")
        endif()
      endif()
    endif()
  endif()
endif()

set(entries "")
string(REPLACE "|" ";" libraries "${LIBRARIES}")
foreach(library IN LISTS libraries)
  if(library MATCHES "^([^=]+)=(.*)$")
    string(APPEND entries "    {\"${CMAKE_MATCH_1}\", \"${CMAKE_MATCH_2}\"},\n")
  endif()
endforeach()
set(text "// Written by write_build_facts.cmake at every build that changes a fact.
#pragma once

#include <utility>

namespace volmark::build_facts {

inline constexpr const char* kVersion = \"${VERSION}\";
inline constexpr const char* kCommit = \"${commit}\";
inline constexpr const char* kDirty = \"${dirty}\";
inline constexpr const char* kFlags = R\"flags(${FLAGS})flags\";
inline constexpr const char* kType = \"${TYPE}\";
inline constexpr std::pair<const char*, const char*> kLibraries[] = {
${entries}};

} // namespace volmark::build_facts
")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} previous)
endif()
if(NOT "${previous}" STREQUAL "${text}")
  file(WRITE ${OUTPUT} "${text}")
endif()
