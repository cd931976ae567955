% Tasks 3 and 4: the torque constant kT = M/I from stall and from peak, and kT(Iq) through both, flat at zero.
v = course_values();
show('kT from stall', v.continuous_stall_torque.value / v.continuous_stall_current.value, 'N*m/A');
show('kT from peak', v.peak_torque.value / v.peak_current.value, 'N*m/A');
[~, coefficients] = torqueconstant(0);
show('a', coefficients(1), 'N*m/A^3');
show('b', coefficients(2), 'N*m/A^2');
show('c', coefficients(3), 'N*m/A');
figure;
Iq = linspace(0, v.peak_current.value, 400);
plot(Iq, torqueconstant(Iq)); xlabel('Iq / A'); ylabel('kT / (N*m/A)'); grid on
keep_figure('task04');
