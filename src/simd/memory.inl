// Loads and stores at any alignment. Kernels include this within an unnamed namespace.

template <typename T>
T read(const void* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}
template <typename T>
void write(void* to, T value) {
  std::memcpy(to, &value, sizeof value);
}
