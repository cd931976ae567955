function [kT, coefficients] = torqueconstant(Iq)
% kT(Iq) = a*Iq^2 + b*Iq + c - N*m/A: flat at zero, through stall and peak; coefficients are [a b c].
v = course_values();
I0 = v.continuous_stall_current.value;
Imax = v.peak_current.value;
conditions = [0 1 0; I0^2 I0 1; Imax^2 Imax 1];
coefficients = (conditions \ [0; v.continuous_stall_torque.value / I0; v.peak_torque.value / Imax])';
kT = polyval(coefficients, Iq);
end
