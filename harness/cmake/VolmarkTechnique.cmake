# volmark_embed_shaders(<target> <prefix> <namespace> <file>...): adds the files as embedded GLSL.
set(VOLMARK_CMAKE_DIR ${CMAKE_CURRENT_LIST_DIR})
function(volmark_embed_shaders target prefix namespace)
  set(files)
  foreach(file IN LISTS ARGN)
    get_filename_component(absolute ${file} ABSOLUTE)
    list(APPEND files ${absolute})
  endforeach()
  string(REPLACE ";" "|" joined "${files}")
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${target}_${prefix}_shaders.cpp)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DPREFIX=${prefix} -DNAMESPACE=${namespace} -DOUTPUT=${output} -DFILES=${joined} -P
            ${VOLMARK_CMAKE_DIR}/embed_shaders.cmake
    DEPENDS ${files} ${VOLMARK_CMAKE_DIR}/embed_shaders.cmake
    COMMENT "Embedding the shaders of ${prefix}"
    VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()

# volmark_add_technique(<family> [TEST_ONLY] SOURCES <cpp>... [SHADERS <glsl>...]): a loadable module of
# techniques. Inside the project it goes to <build>/techniques (TEST_ONLY: <build>/tests/techniques, and is not
# installed); with find_package(volmark) to the current binary folder.
function(volmark_add_technique family)
  cmake_parse_arguments(arg "TEST_ONLY" "" "SOURCES;SHADERS" ${ARGN})
  add_library(${family} MODULE ${arg_SOURCES})
  set_target_properties(${family} PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_compile_features(${family} PRIVATE cxx_std_20)
  target_link_libraries(${family} PRIVATE volmark::volmark)
  target_include_directories(${family} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  volmark_embed_shaders(${family} ${family} volmark_embedded ${arg_SHADERS})
  if(COMMAND volmark_compile_options)
    volmark_compile_options(${family})
    if(arg_TEST_ONLY)
      set_target_properties(${family} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests/techniques)
    else()
      set_target_properties(${family} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/techniques
                                                 INSTALL_RPATH "$ORIGIN/../..")
      install(TARGETS ${family} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/volmark/techniques)
    endif()
  endif()
endfunction()
