find_program(NPM npm REQUIRED)

# Installs what package-lock.json of the current folder pins into `folder`/node_modules, once for each change of the
# lock. Sets `stamp` to the file that tells so.
function(octurn_npm_packages folder stamp)
  set(installed ${folder}/node_modules/.package-lock.json)
  add_custom_command(
    OUTPUT ${installed}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}
    COMMAND ${CMAKE_COMMAND} -E copy ${CMAKE_CURRENT_SOURCE_DIR}/package.json
            ${CMAKE_CURRENT_SOURCE_DIR}/package-lock.json ${folder}
    COMMAND ${CMAKE_COMMAND} -E chdir ${folder} ${NPM} ci --ignore-scripts --no-audit --no-fund --loglevel=error
    COMMAND ${CMAKE_COMMAND} -E touch ${installed}
    DEPENDS package.json package-lock.json
    COMMENT "Fetching npm packages of ${CMAKE_CURRENT_SOURCE_DIR}"
    VERBATIM)
  set(${stamp} ${installed} PARENT_SCOPE)
endfunction()
