#include "native/table_data.h"

namespace gicodec::native {

const std::uint16_t kTableNumbers[kTableCount] = {
#include "native/tables.txt"
};

}  // namespace gicodec::native
