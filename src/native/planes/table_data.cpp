#include "native/planes/table_data.h"

namespace gicodec::native {

const std::uint16_t kTableNumbers[kTableCount] = {
#include "native/planes/tables.txt"
};

}  // namespace gicodec::native
