// What gicodec_test_headers is made with; it has no code of its own.
