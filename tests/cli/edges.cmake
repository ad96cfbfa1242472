# Limits of files, terminals and numbers: cases by name. edges.py contains their requirements.
foreach(case missing_pictures stride_of_pictures special_files huge_claims fine_texture no_threads limits export_targets
             lost_output empty_values impossible_numbers control_characters video_that_begins_late targets_alone)
  add_test(NAME cli.edge_${case} COMMAND ${MOIREGAUGE_PYTHON} ${CMAKE_CURRENT_LIST_DIR}/edges.py
           $<TARGET_FILE:moiregauge> ${CMAKE_BINARY_DIR}/cli-work/edge_${case} ${PROJECT_SOURCE_DIR} case_${case})
  set_tests_properties(cli.edge_${case} PROPERTIES LABELS cli TIMEOUT 300 ENVIRONMENT "${MOIREGAUGE_LEAKS}")
endforeach()
