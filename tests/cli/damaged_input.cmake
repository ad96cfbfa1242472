# Damaged and hostile input: cases 1 to 14 by name. damaged_input.py contains their requirements.
foreach(case 01_no_such_input 02_no_video 03_index_lost 04_cut_at_60_percent 05_damaged_bytes 05_damaged_pictures 06_hole
             07_frame_size_changes 08_time_runs_backwards 09_variable_frame_rate 10_depth_and_rotation 11_too_few_frames
             12_inputs_that_name_others 13_bombs 14_decoder_crashes 14_decoder_hangs)
  add_test(NAME cli.case_${case} COMMAND ${MOIREGAUGE_PYTHON} ${CMAKE_CURRENT_LIST_DIR}/damaged_input.py
           $<TARGET_FILE:moiregauge> ${CMAKE_BINARY_DIR}/cli-work/case_${case} ${PROJECT_SOURCE_DIR} case_${case})
  set_tests_properties(cli.case_${case} PROPERTIES LABELS cli TIMEOUT 300 ENVIRONMENT "${MOIREGAUGE_LEAKS}")
endforeach()
