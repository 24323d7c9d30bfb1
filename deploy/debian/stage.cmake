# Run by cpack: what the Debian package has besides `cmake --install`.
set(root ${CPACK_TEMPORARY_INSTALL_DIRECTORY})
file(GLOB configurations ${CPACK_CONAV_CONFIG}/*.yaml)
list(FILTER configurations EXCLUDE REGEX "annotators|scenarios|search_variants")
file(COPY ${configurations} DESTINATION ${root}/etc/conav)
file(MAKE_DIRECTORY ${root}/usr/bin)
file(CREATE_LINK ../lib/conav/conav ${root}/usr/bin/conav SYMBOLIC)
