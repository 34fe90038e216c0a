# What `cmake --install` and the Debian packages consist of. Components are
# packages: tools, dev (the library), python.
set(EVO_DATA_DIR ${CMAKE_INSTALL_DATADIR}/evo)
install(DIRECTORY tasks DESTINATION ${EVO_DATA_DIR} COMPONENT tools)
install(DIRECTORY scripts/ DESTINATION ${EVO_DATA_DIR}/scripts COMPONENT tools
        USE_SOURCE_PERMISSIONS
        FILES_MATCHING PATTERN "*.mk" PATTERN "*.gnuplot" PATTERN "*.jq" PATTERN "*.awk"
        PATTERN "*-slots" PATTERN "slurm/*" PATTERN "completion" EXCLUDE)
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools)

# Completion is loaded by the name of a tool (bash), or of the function (zsh).
foreach(tool ${EVO_TOOLS})
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

# ---- Debian packages: cpack -G DEB ---------------------------------------------
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME evo)
set(CPACK_PACKAGE_VENDOR "the evo developers")
set(CPACK_PACKAGE_CONTACT "the evo developers <evo@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL tools)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME evo)
set(CPACK_DEBIAN_TOOLS_DESCRIPTION "${PROJECT_DESCRIPTION}
 Small Unix tools that sample, mutate, train, evaluate, select and render robots
 made of voxels on the 32 tasks of the Evolution Gym benchmark.")
# What the pipelines call; videos and plots do without it when asked for others.
set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS "make, jq")
set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS "ffmpeg, gnuplot-nox")
include(CPack)
