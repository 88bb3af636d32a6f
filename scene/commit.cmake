# Writes OUTPUT from TEMPLATE with the commit of SOURCE_DIR and whether its tracked files are unchanged. Kept records do
# not count: no run reads them, and a suite that keeps one case's would call its next case's source changed.
# Without git, or outside a repository, both are "unknown". OUTPUT keeps its date if nothing changed.
set(COMMIT unknown)
set(CLEAN unknown)
find_program(GIT git)
if(GIT)
  # A copy of the sources inside somebody else's repository must not take that one's commit.
  execute_process(COMMAND ${GIT} -C ${SOURCE_DIR} rev-parse --show-prefix HEAD
    OUTPUT_VARIABLE answer ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed AND answer MATCHES "^\n([0-9a-f]+)\n$")
    set(hash ${CMAKE_MATCH_1})
    set(COMMIT ${hash})
    execute_process(COMMAND ${GIT} -C ${SOURCE_DIR} --no-optional-locks status --porcelain
        --untracked-files=no -- . ":(exclude)validation/*/records/*" ":(exclude)validation/numerics_study/*"
      OUTPUT_VARIABLE changes ERROR_QUIET RESULT_VARIABLE failed)
    if(NOT failed)
      if(changes STREQUAL "")
        set(CLEAN yes)
      else()
        set(CLEAN no)
      endif()
    endif()
  endif()
endif()
configure_file(${TEMPLATE} ${OUTPUT} @ONLY)
