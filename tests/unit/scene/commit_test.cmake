# scene/commit.cmake in a repository of its own: commit and clean flag, a file that keeps its date, and
# "unknown" outside any repository.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/repository/inside)
set(output ${FOLDER}/commit.cpp)

function(look source commit clean)
  execute_process(COMMAND ${CMAKE_COMMAND} -DSOURCE_DIR=${source} -DOUTPUT=${output}
    -DTEMPLATE=${SCENE}/commit.cpp.in -P ${SCENE}/commit.cmake COMMAND_ERROR_IS_FATAL ANY)
  file(READ ${output} text)
  if(NOT text MATCHES "commit = \"${commit}\"" OR NOT text MATCHES "clean = \"${clean}\"")
    message(FATAL_ERROR "expected commit ${commit}, clean ${clean}; got\n${text}")
  endif()
endfunction()

function(git)
  execute_process(COMMAND git -C ${FOLDER}/repository -c user.name=Test -c user.email=test@example.org
    ${ARGN} OUTPUT_VARIABLE answer OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  set(answer ${answer} PARENT_SCOPE)
endfunction()

git(init -q)
file(WRITE ${FOLDER}/repository/tracked "one\n")
git(add tracked)
git(commit -q -m first)
git(rev-parse HEAD)
set(first ${answer})
look(${FOLDER}/repository ${first} yes)

file(TIMESTAMP ${output} before "%s" UTC)
execute_process(COMMAND ${CMAKE_COMMAND} -E sleep 1.1)
file(WRITE ${FOLDER}/repository/untracked "two\n")
look(${FOLDER}/repository ${first} yes)
file(TIMESTAMP ${output} after "%s" UTC)
if(NOT before STREQUAL after)
  message(FATAL_ERROR "commit.cpp was rewritten although nothing changed: everything would relink")
endif()

file(WRITE ${FOLDER}/repository/tracked "three\n")
look(${FOLDER}/repository ${first} no)
# Sources that lie inside somebody else's repository do not carry its commit.
look(${FOLDER}/repository/inside unknown unknown)
set(ENV{GIT_CEILING_DIRECTORIES} ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/plain)
look(${FOLDER}/plain unknown unknown)
