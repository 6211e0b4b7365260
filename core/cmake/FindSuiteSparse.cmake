# FindSuiteSparse: SuiteSparse::SuiteSparse = UMFPACK, KLU, CHOLMOD, AMD and what they rest on.
# SuiteSparse ships its own CMake packages only from version 7; Debian 12 has 5.12 and none.
find_path(SuiteSparse_INCLUDE_DIR SuiteSparse_config.h PATH_SUFFIXES suitesparse)
mark_as_advanced(SuiteSparse_INCLUDE_DIR)

# Users before used, the order static libraries need.
set(SuiteSparse_LIBRARIES "")
foreach(name umfpack klu btf cholmod camd ccolamd colamd amd suitesparseconfig)
  find_library(SuiteSparse_${name}_LIBRARY ${name})
  mark_as_advanced(SuiteSparse_${name}_LIBRARY)
  list(APPEND SuiteSparse_LIBRARIES "${SuiteSparse_${name}_LIBRARY}")
  list(APPEND required SuiteSparse_${name}_LIBRARY)
endforeach()

if(SuiteSparse_INCLUDE_DIR)
  file(STRINGS "${SuiteSparse_INCLUDE_DIR}/SuiteSparse_config.h" lines
       REGEX "^#define SUITESPARSE_(MAIN|SUB|SUBSUB)_VERSION +[0-9]+")
  string(REGEX MATCHALL "[0-9]+" SuiteSparse_VERSION "${lines}")
  list(JOIN SuiteSparse_VERSION "." SuiteSparse_VERSION)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SuiteSparse REQUIRED_VARS SuiteSparse_INCLUDE_DIR ${required}
                                  VERSION_VAR SuiteSparse_VERSION)
unset(required)
if(SuiteSparse_FOUND AND NOT TARGET SuiteSparse::SuiteSparse)
  add_library(SuiteSparse::SuiteSparse INTERFACE IMPORTED)
  target_include_directories(SuiteSparse::SuiteSparse INTERFACE "${SuiteSparse_INCLUDE_DIR}")
  target_link_libraries(SuiteSparse::SuiteSparse INTERFACE ${SuiteSparse_LIBRARIES})
endif()
