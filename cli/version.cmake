# Writes the header TO from version.h.in, where it would differ: VERSION, and the commit
# that SOURCE has checked out, with a "+" where files of it have been changed since.
execute_process(COMMAND git -C ${SOURCE} describe --always --exclude=* --dirty=+
                OUTPUT_VARIABLE EVO_COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT EVO_COMMIT)
  set(EVO_COMMIT "no commit")
endif()
set(PROJECT_VERSION ${VERSION})
configure_file(${CMAKE_CURRENT_LIST_DIR}/version.h.in ${TO} @ONLY)
