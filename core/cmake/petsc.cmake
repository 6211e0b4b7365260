# ORTHANT_PETSC: PETSc and MPI are found and wanted; then the target orthant_petsc_libraries has both.
# PETSc is found by pkg-config. Sanitizers report what MPI leaks: not with them.
option(ORTHANT_WITH_PETSC "Build orthant_distributed and the plugin petsc, if PETSc and MPI are found"
       ${PROJECT_IS_TOP_LEVEL})
set(ORTHANT_PETSC OFF)
if(ORTHANT_WITH_PETSC AND NOT CMAKE_BUILD_TYPE MATCHES "^(Asan|Tsan|Coverage|Fuzz)$")
  find_package(PkgConfig QUIET)
  if(PkgConfig_FOUND)
    pkg_check_modules(PETSC QUIET "PETSc>=3.18")
  endif()
  if(PETSC_FOUND)
    set(MPI_CXX_SKIP_MPICXX ON)
    find_package(MPI QUIET COMPONENTS CXX)
  endif()
  if(PETSC_FOUND AND MPI_CXX_FOUND)
    include(CheckCXXSourceCompiles)
    set(CMAKE_REQUIRED_INCLUDES ${PETSC_INCLUDE_DIRS} ${MPI_CXX_INCLUDE_DIRS})
    check_cxx_source_compiles("#include <petscconf.h>
      #if defined(PETSC_USE_COMPLEX) || defined(PETSC_USE_64BIT_INDICES) || !defined(PETSC_USE_REAL_DOUBLE)
      #error numbers of another kind
      #endif
      int main() { return 0; }" ORTHANT_PETSC_HAS_DOUBLES)
    unset(CMAKE_REQUIRED_INCLUDES)
    if(ORTHANT_PETSC_HAS_DOUBLES)
      set(ORTHANT_PETSC ON)
      add_library(orthant_petsc_libraries INTERFACE)
      target_include_directories(orthant_petsc_libraries SYSTEM INTERFACE ${PETSC_INCLUDE_DIRS})
      target_link_libraries(orthant_petsc_libraries INTERFACE ${PETSC_LINK_LIBRARIES} MPI::MPI_CXX)
    endif()
  endif()
endif()
if(NOT ORTHANT_PETSC)
  message(STATUS "Without problems distributed over MPI (PETSc 3.18, real numbers, 32-bit indices)")
endif()
