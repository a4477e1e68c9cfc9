# volmark_build_facts(<target>): gives the target <volmark/build_facts.h>: version, commit, compiler flags and
# library versions. The commit is looked up at every build; the header changes only when a fact does.
find_package(Git QUIET)
function(volmark_build_facts target)
  string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
  string(STRIP "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}}" flags)
  if(VOLMARK_SANITIZE)
    string(APPEND flags " -fsanitize=address,undefined")
  endif()
  set(libraries "")
  foreach(library IN ITEMS "fmt=${fmt_VERSION}" "glm=${glm_VERSION}" "glslang=${glslang_VERSION}"
                           "nlohmann_json=${nlohmann_json_VERSION}" "openexr=${openexr_VERSION}"
                           "vulkan_headers=${Vulkan_VERSION}" "xxhash=${xxhash_VERSION}" "zlib=${ZLIB_VERSION_STRING}")
    string(APPEND libraries "${library}|")
  endforeach()
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/${target}_facts)
  add_custom_target(
    ${target}_facts
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${folder}/volmark/build_facts.h -DSOURCE=${PROJECT_SOURCE_DIR}
            -DVERSION=${PROJECT_VERSION} -DGIT=${GIT_EXECUTABLE} -DFLAGS=${flags} -DTYPE=${CMAKE_BUILD_TYPE}
            -DLIBRARIES=${libraries} -P ${VOLMARK_CMAKE_DIR}/write_build_facts.cmake
    BYPRODUCTS ${folder}/volmark/build_facts.h
    COMMENT "Looking up the commit"
    VERBATIM)
  add_dependencies(${target} ${target}_facts)
  target_include_directories(${target} PRIVATE ${folder})
endfunction()
