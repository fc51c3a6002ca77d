# Turns a recording of `sagnac simulate` into the file of a data logger: header lines, semicolons, decimal commas, a status.
BEGIN {
    FS = ","
    print "FOG test bench 3"
    print "S/N: " unit
    print "Time;Omega_Z [deg/h];T_housing [degC];Status"
}
NR > 1 {
    row = $1 ";" $2 ";" $3
    gsub(/\./, ",", row)
    print row ";OK"
}
