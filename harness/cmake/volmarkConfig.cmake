# find_package(volmark): the target volmark::volmark and the function volmark_add_technique().
include(CMakeFindDependencyMacro)
find_dependency(Vulkan)
find_dependency(glm)
find_dependency(Threads)
include(${CMAKE_CURRENT_LIST_DIR}/volmark_targets.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/VolmarkTechnique.cmake)
