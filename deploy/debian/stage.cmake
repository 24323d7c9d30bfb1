# Run by cpack: what the Debian package has besides `cmake --install`.
set(root ${CPACK_TEMPORARY_INSTALL_DIRECTORY})
file(GLOB configurations ${CPACK_CONAV_CONFIG}/*.yaml)
list(FILTER configurations EXCLUDE REGEX "annotators|hosts|scenarios|search_variants|/study[.]yaml$")
file(COPY ${configurations} DESTINATION ${root}/etc/conav)
# Named as the units name their services.
file(RENAME ${root}/etc/conav/robot.yaml ${root}/etc/conav/driver.yaml)
file(RENAME ${root}/etc/conav/simulated_operator.yaml ${root}/etc/conav/simulated-operator.yaml)
file(RENAME ${root}/etc/conav/eye_tracker.yaml ${root}/etc/conav/eye-tracker.yaml)
file(COPY ${CPACK_CONAV_CONFIG}/../systemd/ DESTINATION ${root}/usr/lib/systemd/system)
file(MAKE_DIRECTORY ${root}/usr/bin)
file(CREATE_LINK ../lib/conav/conav ${root}/usr/bin/conav SYMBOLIC)
