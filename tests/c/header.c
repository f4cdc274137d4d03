// A header alone, and twice.
#include GICODEC_HEADER
#include GICODEC_HEADER

gicodec_status gicodec_header_compiles(void);
gicodec_status gicodec_header_compiles(void) { return GICODEC_OK; }
