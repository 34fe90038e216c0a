# What `cmake --install` and the Debian packages consist of. Components are
# packages: tools, library, dev, python.
set(EVO_DATA_DIR ${CMAKE_INSTALL_DATADIR}/evo)
install(DIRECTORY tasks DESTINATION ${EVO_DATA_DIR} COMPONENT tools)
# The links of the documents lead to what is there.
install(FILES LICENSE README.md CHANGELOG.md CITATION.cff CONTRIBUTING.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools)
install(DIRECTORY docs examples benchmarks records DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools
        USE_SOURCE_PERMISSIONS PATTERN man EXCLUDE)
install(FILES bindings/python/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/bindings/python COMPONENT tools)
install(FILES bindings/web/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/bindings/web COMPONENT tools)
install(FILES bindings/c/evo/evo.h DESTINATION ${CMAKE_INSTALL_DOCDIR}/bindings/c/evo COMPONENT tools)
install(DIRECTORY tasks DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools
        FILES_MATCHING PATTERN "physics/*" PATTERN "training/*" PATTERN "examples/*" PATTERN "easier/*" PATTERN "recipes/*"
        PATTERN "neat.yaml")

# Completion is loaded by the name of a tool (bash), or of the function (zsh).
foreach(tool evo ${EVO_TOOLS})
  install(FILES scripts/completion/evo.bash RENAME ${tool} COMPONENT tools
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
endforeach()
if(EXISTS /etc/debian_version)
  set(EVO_ZSH_FUNCTIONS zsh/vendor-completions)
else()
  set(EVO_ZSH_FUNCTIONS zsh/site-functions)
endif()
install(FILES scripts/completion/_evo COMPONENT tools
        DESTINATION ${CMAKE_INSTALL_DATADIR}/${EVO_ZSH_FUNCTIONS})
# Where Debian's Python looks: for its package alone, others have pip.
install(DIRECTORY bindings/python/evo_robots DESTINATION lib/python3/dist-packages COMPONENT python
        EXCLUDE_FROM_ALL PATTERN __pycache__ EXCLUDE)

# ---- Debian packages: cpack -G DEB ---------------------------------------------
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME evo)
set(CPACK_PACKAGE_VENDOR "the evo developers")
set(CPACK_PACKAGE_CONTACT "the evo developers <evo@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL tools library dev python)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME evo)
set(CPACK_DEBIAN_TOOLS_DESCRIPTION "${PROJECT_DESCRIPTION}
 Small Unix tools that sample, mutate, train, evaluate, select and render robots
 made of voxels on the 32 tasks of the Evolution Gym benchmark.")
# What runs call; videos do without it when asked for others.
set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS "make, libosmesa6")
set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS "ffmpeg, hdf5-tools, jq")

set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libevo${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "${PROJECT_DESCRIPTION} (shared library)
 Environments and training for programs of your own; the tasks are in evo.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "evo (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_GENERATE_SHLIBS ON)

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libevo-dev)
set(CPACK_DEBIAN_DEV_DESCRIPTION "${PROJECT_DESCRIPTION} (development files)
 The header of the library, evo/evo.h, for C and C++, with what CMake and pkg-config need.")
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "${CPACK_DEBIAN_LIBRARY_PACKAGE_NAME} (= ${PROJECT_VERSION})")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-evo-robots)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "${PROJECT_DESCRIPTION} (Python package)
 Gymnasium's interface to the environments, and readers of the tools' files.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "evo (= ${PROJECT_VERSION}), ${CPACK_DEBIAN_LIBRARY_PACKAGE_NAME} (= ${PROJECT_VERSION}), python3:any, python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-h5py")

foreach(component TOOLS LIBRARY DEV PYTHON)
  string(TOLOWER ${component} name)
  set(not_by_default)
  if(name STREQUAL python)
    set(not_by_default EXCLUDE_FROM_ALL)
  endif()
  install(FILES LICENSE RENAME copyright COMPONENT ${name} ${not_by_default}
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${component}_PACKAGE_NAME})
endforeach()
include(CPack)
