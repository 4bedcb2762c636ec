# find_package(casca): the target casca::casca, static if there is a static library, else shared;
# casca::static and casca::shared name one. This file lies in <prefix>/lib/cmake/casca.
get_filename_component(_casca_lib "${CMAKE_CURRENT_LIST_DIR}/../.." ABSOLUTE)
get_filename_component(_casca_prefix "${_casca_lib}/.." ABSOLUTE)

find_path(_casca_include casca.h PATHS "${_casca_prefix}/include" NO_DEFAULT_PATH NO_CACHE)
find_library(_casca_static NAMES libcasca.a casca.lib PATHS "${_casca_lib}" NO_DEFAULT_PATH NO_CACHE)
find_library(_casca_shared NAMES libcasca.so libcasca.dylib casca.dll.lib
             PATHS "${_casca_lib}" NO_DEFAULT_PATH NO_CACHE)

# Libraries of the system that the static library needs.
set(_casca_system "")
if(WIN32)
  set(_casca_system kernel32 ntdll userenv ws2_32 dbghelp)
elseif(UNIX)
  find_package(Threads REQUIRED)
  set(_casca_system Threads::Threads ${CMAKE_DL_LIBS} m)
endif()

if(_casca_static AND NOT TARGET casca::static)
  add_library(casca::static STATIC IMPORTED)
  set_target_properties(casca::static PROPERTIES
    IMPORTED_LOCATION "${_casca_static}"
    INTERFACE_INCLUDE_DIRECTORIES "${_casca_include}"
    INTERFACE_LINK_LIBRARIES "${_casca_system}")
endif()
if(_casca_shared AND NOT TARGET casca::shared)
  add_library(casca::shared UNKNOWN IMPORTED)
  set_target_properties(casca::shared PROPERTIES
    IMPORTED_LOCATION "${_casca_shared}"
    INTERFACE_INCLUDE_DIRECTORIES "${_casca_include}")
endif()

if(NOT TARGET casca::casca)
  add_library(casca::casca INTERFACE IMPORTED)
  if(TARGET casca::static)
    set_target_properties(casca::casca PROPERTIES INTERFACE_LINK_LIBRARIES casca::static)
  elseif(TARGET casca::shared)
    set_target_properties(casca::casca PROPERTIES INTERFACE_LINK_LIBRARIES casca::shared)
  endif()
endif()

set(casca_FOUND FALSE)
if(_casca_include AND (TARGET casca::static OR TARGET casca::shared))
  set(casca_FOUND TRUE)
else()
  set(casca_NOT_FOUND_MESSAGE "neither libcasca nor casca.h is below ${_casca_prefix}")
endif()
